"""A round basin of stone, turned into the triangles of basin.ply.

Its wall leans in a little over a hollow that begins at the floor: water that runs outwards is led up and back. The
coping is flat, with round edges.

The axis is y, the origin in the middle of the floor. Lengths are those of the scene [m].
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import trimesh

from common.ply import write_mesh

FOLDER = Path(__file__).parent
FLOOR = 1.85
"""Radius of the level floor."""
HOLLOW = 0.36
"""Radius of the hollow, which begins there."""
OVERHANG = 42
"""How far past the upright the hollow goes [deg]."""
EDGE = 0.06
"""Radius of the edges of the coping."""
COPING = 0.34
"""Its width."""
WALL = 0.06
"""How far the coping stands out over the wall outside."""
SWELL = 0.02
"""Of the wall outside, which is upright below and above: faces that lie in one plane are mended as if they cut through
each other."""
BASE = 0.16
"""Of the floor over the ground."""
SECTIONS = 80
"""Triangles around the axis."""


def arc(centre, radius, start, end, steps):
    """Points of a circle, by angles from the radial direction upwards [deg]."""
    angle = np.deg2rad(np.linspace(start, end, steps))
    return np.array(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def profile():
    """The outline from the axis below, outside upwards, over the coping and inside down to the axis."""
    middle = np.array([FLOOR, HOLLOW])
    inner = arc(middle, HOLLOW + EDGE, OVERHANG, OVERHANG, 1)[0]
    outer = inner + np.array([COPING - 2 * EDGE, 0])
    outside = outer[0] + EDGE - WALL
    below = np.array([[outside * share, -BASE] for share in (0, 0.25, 0.5, 0.75)])
    foot = arc((outside - EDGE, EDGE - BASE), EDGE, -90, 0, 6)
    wall = np.array([[outside + SWELL, (outer[1] - EDGE) * 0.6]])
    rim = np.vstack(
        [
            [outside, outer[1] - EDGE],
            arc(outer, EDGE, -90, 90, 11)[1:],
            arc(inner, EDGE, 90, OVERHANG + 180, 11),
        ]
    )
    hollow = arc(middle, HOLLOW, OVERHANG, -90, 20)[1:]
    floor = np.array([[FLOOR * share, 0] for share in (0.75, 0.5, 0.25, 0)])
    return np.vstack([below, foot, wall, rim, hollow, floor])


def revolved(outline):
    """Vertices, shape [n, 3], and triangles, shape [m, 3], of what an outline encloses as it turns about y."""
    mesh = trimesh.creation.revolve(np.where(np.abs(outline) < 1e-12, 0, outline), sections=SECTIONS)
    return mesh.vertices[:, [1, 2, 0]], mesh.faces


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Model a basin, and write it as a binary PLY mesh.")
    parser.add_argument("--out", type=Path, default=FOLDER, metavar="FOLDER", help="default: beside the script")
    write_mesh(parser.parse_args(arguments).out / "basin.ply", *revolved(profile()))


if __name__ == "__main__":
    sys.exit(main())
