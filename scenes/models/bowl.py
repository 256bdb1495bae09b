"""A bowl, and the water that fills it: two solids of revolution, turned into the triangles of bowl.ply and water.ply.

The wall lies along half an ellipse and is equally thick everywhere, so that no particle finds a thin spot; its lip is
round. Below is a foot to stand on. The water reaches into the wall, where no particle starts, and up to a level.

The axis is y, and the bowl is one unit wide. Its origin is on the axis, a tenth below the lip: there it hangs evenly
enough to be tipped. The water fits when it is scaled and placed as the bowl is.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import trimesh

from common.ply import write_mesh

FOLDER = Path(__file__).parent
THICKNESS = 0.056
RADIUS = 0.5 - THICKNESS / 2
"""Of the middle of the wall at the lip."""
DEPTH = 0.31
"""From the lip to the bottom, in the middle of the wall."""
LIP = 0.1 - THICKNESS / 2
"""Height of the end of the wall's middle; the rounding comes on top."""
FOOT = (0.19, 0.03)
"""Radius and height of the foot."""
LEVEL = -0.015
"""Of the water, over the origin."""
SECTIONS = 80
"""Triangles around the axis."""


def wall(offset, steps=18, end=np.pi / 2):
    """Radii and heights along the wall from the axis up, `offset` outside its middle, shape [n, 2]."""
    angle = np.linspace(0, end, steps)
    middle = np.stack([RADIUS * np.sin(angle), LIP - DEPTH * np.cos(angle)], axis=1)
    normal = np.stack([DEPTH * np.sin(angle), -RADIUS * np.cos(angle)], axis=1)
    return middle + offset * normal / np.linalg.norm(normal, axis=1, keepdims=True)


def arc(centre, radius, start, end, steps):
    """Points of a circle, by angles from the radial direction upwards [deg]."""
    angle = np.deg2rad(np.linspace(start, end, steps))
    return np.array(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def profile():
    """The outline of the bowl from the axis below, outside upwards, over the lip and inside down to the axis."""
    outside, inside = wall(THICKNESS / 2), wall(-THICKNESS / 2)[::-1]
    radius, height = FOOT
    bottom, round_edge = outside[0, 1] - height, height / 3
    foot = np.array([[radius * share, bottom] for share in (0, 0.3, 0.6)])
    edge = arc((radius - round_edge, bottom + round_edge), round_edge, -90, 0, 5)
    lip = arc((RADIUS, LIP), THICKNESS / 2, 0, 180, 13)
    outside = outside[(outside[:, 0] > radius + 0.01) & (outside[:, 0] > 0)]
    return np.vstack([foot, edge, outside[:-1], lip, inside[1:]])


def filling():
    """The outline of the water: along the middle of the wall up to the level, and back to the axis."""
    side = wall(0, end=np.arccos((LIP - LEVEL) / DEPTH))
    surface = np.array([[side[-1, 0] * share, LEVEL] for share in (0.75, 0.5, 0.25, 0)])
    return np.vstack([side, surface])


def revolved(outline):
    """Vertices, shape [n, 3], and triangles, shape [m, 3], of what an outline encloses as it turns about y."""
    outline = np.where(np.abs(outline) < 1e-12, 0, outline)
    mesh = trimesh.creation.revolve(outline, sections=SECTIONS)
    return mesh.vertices[:, [1, 2, 0]], mesh.faces


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Model a bowl and its water, and write them as binary PLY meshes.")
    parser.add_argument("--out", type=Path, default=FOLDER, metavar="FOLDER", help="default: beside the script")
    options = parser.parse_args(arguments)
    write_mesh(options.out / "bowl.ply", *revolved(profile()))
    write_mesh(options.out / "water.ply", *revolved(filling()))


if __name__ == "__main__":
    sys.exit(main())
