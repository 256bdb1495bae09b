"""A stirring paddle: a blade with holes on both sides of a hub, turned into the triangles of paddle.ply.

The shape is a distance to smooth parts, polygonised by marching cubes. The blade is bent like an S seen from above, so
that both of its sides scoop what they are driven into.

It turns about y. Its origin is on the axis, in the middle of the blade's height. Lengths are those of the scene [m].
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import pysplashsurf

from common.ply import write_mesh

FILE = Path(__file__).with_name("paddle.ply")
HALF = (0.35, 0.15)
"""Half the length and height of the blade."""
CORNER = 0.06
"""Radius of its corners."""
THICK = 0.021
"""Half its thickness; its edges are round."""
BEND = 0.05
"""How far the middle of each side is beside the plane through the ends and the axis."""
HOLES = ((0.135, 0.0), (0.255, 0.0))
"""Places of holes on one side, along the blade and up."""
HOLE = 0.042
"""Their radius."""
HUB = (0.048, 0.17)
"""Radius of the hub and half its height."""
SEAM = 0.03
"""Width of the rounding between hub and blade."""
CELL = 0.011
"""Edge of a marching cube."""


def union(first, second, seam):
    """The smooth minimum of two distances (Inigo Quilez, https://iquilezles.org/articles/smin)."""
    overlap = np.maximum(seam - np.abs(first - second), 0) / seam
    return np.minimum(first, second) - seam * overlap**2 / 4


def rounded(across, along, radius):
    """Distance to what has two distances below zero, with round edges."""
    outside = np.hypot(np.maximum(across + radius, 0), np.maximum(along + radius, 0))
    return outside + np.minimum(np.maximum(across, along) + radius, 0) - radius


def distance(points):
    """About the distance to the paddle, of points of shape [3, n]."""
    x, y, z = points
    way = np.stack([np.abs(x) - HALF[0] + CORNER, np.abs(y) - HALF[1] + CORNER])
    outline = np.linalg.norm(np.maximum(way, 0), axis=0) + np.minimum(way.max(axis=0), 0) - CORNER
    for along, up in HOLES:
        outline = np.maximum(outline, HOLE - np.hypot(np.abs(x) - along, y - up))
    beside = z - BEND * np.sin(np.pi * np.clip(x / HALF[0], -1, 1))
    blade = rounded(np.abs(beside) - THICK, outline, THICK)
    hub = rounded(np.hypot(x, z) - HUB[0], np.abs(y) - HUB[1], 0.012)
    return union(blade, hub, SEAM)


def paddle():
    """Vertices, shape [n, 3], and triangles, shape [m, 3]."""
    reach = np.array([HALF[0], HUB[1], BEND + THICK]) + 2.5 * CELL
    axes = [np.arange(-np.ceil(far / CELL), np.ceil(far / CELL) + 1) * CELL for far in reach]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"))
    inside = -distance(grid.reshape(3, -1)).reshape(grid.shape[1:]).astype(np.float32)
    mesh = pysplashsurf.marching_cubes(inside / CELL, iso_surface_threshold=0.0, cube_size=1.0)
    return np.asarray(mesh.vertices) * CELL + [axis[0] for axis in axes], np.asarray(mesh.triangles)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Model a paddle, and write it as a binary PLY mesh.")
    parser.add_argument("--out", type=Path, default=FILE, metavar="FILE", help="default: beside the script")
    write_mesh(parser.parse_args(arguments).out, *paddle())


if __name__ == "__main__":
    sys.exit(main())
