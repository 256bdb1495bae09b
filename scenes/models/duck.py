"""A rubber duck: a smooth implicit shape, turned into the triangles of duck.ply.

The shape is a union of ellipsoids with rounded seams, by the smooth minimum of Inigo Quilez
(https://iquilezles.org/articles/smin). One half of it is polygonised by marching cubes on a grid that is finer
around the face, evened out along the surface, and mirrored. The vertices carry the colours of beak, eyes and plumage.

The duck looks along +z, y is up, and it is one unit long. Its origin is the centre of its volume. Filled evenly, it
floats upright at any density up to half of the water's.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import pysplashsurf

from common.ply import write_mesh

FILE = Path(__file__).with_name("duck.ply")
CELLS = 27
"""Cells of the grid along the length. This number leaves no thin triangles; others may, where the colours meet."""
YELLOW, ORANGE, BLACK = (252, 200, 18), (238, 98, 10), (12, 11, 11)
ROUNDS = 15
"""How often vertices move towards the middle of their neighbours."""


def ellipsoid(points, centre, radii, pitch=0.0, yaw=0.0):
    """About the distance to an ellipsoid whose front is lowered by `pitch` and turned towards +x by `yaw` [deg]."""
    x, y, z = points - np.array(centre)[:, None]
    cosine, sine = np.cos(np.deg2rad(yaw)), np.sin(np.deg2rad(yaw))
    x, z = cosine * x - sine * z, sine * x + cosine * z
    cosine, sine = np.cos(np.deg2rad(pitch)), np.sin(np.deg2rad(pitch))
    y, z = cosine * y + sine * z, cosine * z - sine * y
    local = np.stack([x, y, z]) / np.array(radii)[:, None]
    reach = np.linalg.norm(local, axis=0)
    return reach * (reach - 1) / np.maximum(np.linalg.norm(local / np.array(radii)[:, None], axis=0), 1e-9)


def union(first, second, seam):
    """The smooth minimum of two distances; `seam` is the width of the rounding."""
    overlap = np.maximum(seam - np.abs(first - second), 0) / seam
    return np.minimum(first, second) - seam * overlap**2 / 4


def common(first, second, seam):
    """The smooth maximum: where both shapes are."""
    return -union(-first, -second, seam)


def plumage(points):
    """Distance to the yellow parts."""
    x, y, z = points
    belly = np.stack([x, y + 0.35 * np.minimum(y - 0.26, 0), z])
    body = ellipsoid(belly, (0, 0.26, 0.0), (0.40, 0.27, 0.47), pitch=3)
    body = union(body, ellipsoid(belly, (0, 0.29, 0.20), (0.32, 0.25, 0.30)), 0.12)
    body = common(body, 0.04 - y, 0.10)
    tail = ellipsoid(points, (0, 0.40, -0.40), (0.17, 0.09, 0.20), pitch=36)
    tail = union(tail, ellipsoid(points, (0, 0.50, -0.50), (0.07, 0.04, 0.13), pitch=50), 0.10)
    body = union(body, tail, 0.18)
    head = ellipsoid(points, (0, 0.71, 0.13), (0.235, 0.222, 0.228))
    head = union(head, ellipsoid(points, (0.10, 0.66, 0.21), (0.125, 0.11, 0.115)), 0.08)
    neck = ellipsoid(points, (0, 0.53, 0.12), (0.19, 0.12, 0.18))
    return union(union(union(body, neck, 0.10), head, 0.06), wing(points, body), 0.02)


def wing(points, body):
    """A relief on the body's side, with three feathers that stand off behind."""
    x, _, z = points
    outline = ellipsoid(points, (0, 0.335, 0.05), (9, 0.125, 0.17), pitch=10)
    for height, back, length in ((0.415, -0.20, 0.13), (0.33, -0.155, 0.13), (0.25, -0.10, 0.11)):
        feather = ellipsoid(points, (0, height, back), (9, 0.058, length), pitch=20)
        outline = union(outline, feather, 0.015)
    relief = body - 0.045 - 0.1 * np.maximum(-0.05 - z, 0)
    return common(common(relief, outline, 0.06), 0.2 - x, 0.05)


def bill(points):
    """Distance to the upper and the lower bill."""
    upper = ellipsoid(points, (0, 0.672, 0.38), (0.12, 0.043, 0.135), pitch=-16)
    upper = union(upper, ellipsoid(points, (0, 0.70, 0.34), (0.06, 0.05, 0.07)), 0.06)
    lower = ellipsoid(points, (0, 0.614, 0.345), (0.088, 0.035, 0.105), pitch=8)
    return union(upper, lower, 0.01)


def eye(points):
    """Distance to the eye."""
    return ellipsoid(points, (0.112, 0.782, 0.295), (0.038, 0.055, 0.038), pitch=-18, yaw=34)


def distance(points):
    """About the distance to the half at x >= 0 of the duck, negative inside; points are columns, shape [3, n]."""
    return union(union(plumage(points), bill(points), 0.025), eye(points), 0.008)


def beyond_beak(points):
    """Positive outside the orange, zero on its rim."""
    return bill(points) - plumage(points)


def beyond_eye(points):
    """Positive outside the black, zero on its rim."""
    return eye(points) - np.minimum(plumage(points), bill(points))


def gradient(function, points):
    """By central differences, shape [3, n]."""
    steps = 1e-4 * np.eye(3)[:, :, None]
    return np.stack([function(points + step) - function(points - step) for step in steps]) / 2e-4


def graded(low, high, fine, cells):
    """Nodes from `low` to `high`, `cells` per unit length and 2.4 times as many within `fine`."""
    x = np.linspace(low, high, 2001)
    density = cells * (1 + 1.4 / (1 + np.exp((fine[0] - x) / 0.03)) / (1 + np.exp((x - fine[1]) / 0.03)))
    number = np.concatenate([[0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(x))])
    return np.interp(np.linspace(0, number[-1], round(number[-1]) + 1), number, x)


def polygonised(cells):
    """Vertices, shape [n, 3], and triangles of the half at x >= 0, whose rim lies at x = 0."""
    axes = (
        graded(0, 0.52, (0, 0.16), 0.8 * cells),
        graded(0, 1, (0.59, 0.85), cells),
        graded(-0.7, 0.6, (0.24, 0.6), cells),
    )
    grid = np.stack(np.meshgrid(*axes, indexing="ij"))
    inside = -distance(grid.reshape(3, -1)).reshape(grid.shape[1:])
    mesh = pysplashsurf.marching_cubes(inside, iso_surface_threshold=0.0, cube_size=1.0)
    places = np.asarray(mesh.vertices).T
    vertices = [np.interp(place, np.arange(len(axis)), axis) for place, axis in zip(places, axes, strict=True)]
    return np.stack(vertices, axis=1), np.asarray(mesh.triangles).astype(np.int64)


def mirrored(half, triangles):
    """The whole duck from its half."""
    off = half[:, 0] > 0
    partner = np.arange(len(half))
    partner[off] = len(half) + np.arange(off.sum())
    return np.vstack([half, half[off] * [-1, 1, 1]]), np.vstack([triangles, partner[triangles][:, ::-1]])


def edges(triangles):
    """Both directions of every edge, shape [m, 2]."""
    return np.unique(triangles[:, [0, 1, 1, 2, 2, 0, 1, 0, 2, 1, 0, 2]].reshape(-1, 2), axis=0)


def onto(function, half):
    """The vertices where the function is zero nearby; those on the rim stay in the plane x = 0."""
    slope = gradient(function, half.T)
    slope[0, half[:, 0] == 0] = 0
    return half - (function(half.T) * slope / (slope**2).sum(axis=0)).T


def evened(half, triangles, fixed):
    """Vertices but for the fixed ones moved along the surface towards the middle of their neighbours."""
    start, end = edges(mirrored(half, triangles)[1]).T
    start, end = start[start < len(half)], end[start < len(half)]
    rim, count = half[:, 0] == 0, np.bincount(start)
    for _ in range(ROUNDS):
        whole, _ = mirrored(half, triangles)
        middle = np.stack([np.bincount(start, column[end]) / count for column in whole.T], axis=1)
        normal = gradient(distance, half.T).T
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        shift = 0.5 * (middle - half)
        shift -= (shift * normal).sum(axis=1, keepdims=True) * normal
        shift[rim, 0] = 0
        half = np.where(fixed[:, None], half, onto(distance, onto(distance, half + shift)))
    return half


def pulled(half, triangles, function):
    """One end of every edge that crosses the function's zero moved onto it, and which ends those are."""
    value = function(half.T)
    slope = gradient(function, half.T)
    value, start, end = value / np.linalg.norm(slope, axis=0), *edges(triangles).T
    crossing = (value[start] < 0) != (value[end] < 0)
    nearer = np.where(np.abs(value[start]) < np.abs(value[end]), start, end)[crossing]
    chosen = np.zeros(len(half), dtype=bool)
    chosen[nearer] = True
    moved = half
    for _ in range(8):
        moved = onto(distance, onto(function, moved))
    return np.where(chosen[:, None], moved, half), chosen


def unit(vertices, triangles):
    """Scaled to unit length, and moved so that the centre of volume is the origin."""
    corners = vertices[triangles]
    sixfold = np.linalg.det(corners)
    centre = (sixfold[:, None] * corners.sum(axis=1)).sum(axis=0) / (4 * sixfold.sum())
    centre[0] = 0
    return (vertices - centre) / np.ptp(vertices[:, 2])


def duck(cells=CELLS):
    """Vertices, shape [n, 3], triangles, shape [m, 3], and the vertices' colours from 0 to 255, shape [n, 3]."""
    half, triangles = polygonised(cells)
    half = evened(half, triangles, fixed=np.zeros(len(half), dtype=bool))
    half, beak_rim = pulled(half, triangles, beyond_beak)
    half, eye_rim = pulled(half, triangles, beyond_eye)
    half = evened(half, triangles, fixed=beak_rim | eye_rim)
    paint = np.full(half.shape, YELLOW, dtype=np.uint8)
    paint[beak_rim | (beyond_beak(half.T) < 0)] = ORANGE
    paint[eye_rim | (beyond_eye(half.T) < 0)] = BLACK
    vertices, triangles = mirrored(half, triangles)
    return unit(vertices, triangles), triangles, np.vstack([paint, paint[half[:, 0] > 0]])


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Model the rubber duck and write it as a binary PLY mesh.")
    parser.add_argument("--out", type=Path, default=FILE, metavar="FILE", help="the mesh (default: beside the script)")
    parser.add_argument(
        "--cells",
        type=int,
        default=CELLS,
        metavar="N",
        help=f"cells of the grid along the length (default {CELLS}: about 10000 triangles)",
    )
    options = parser.parse_args(arguments)
    write_mesh(options.out, *duck(options.cells))


if __name__ == "__main__":
    sys.exit(main())
