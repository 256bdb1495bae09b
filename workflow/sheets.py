"""Thin sheets of fluid, made whole and flat before their surface is looked for.

Where fluid lies in one layer, its particles are the bumps of its surface, and holes open as soon as they part.
Such layers are filled where they are stretched (Ando, Thürey & Tsuruno 2012, "Preserving Fluid Sheets with Adaptively
Sampled Anisotropic Particles") and flattened by the mean of what is around (Yu & Turk 2013, "Reconstructing Surfaces
of Particle-Based Fluids Using Anisotropic Kernels", equation 6). Only the surface sees the result.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from workflow.surface_spec import Sheets

NEXT = 1.5
"""Particles nearer than this are next to one another, in spacings: 8 in a layer, 18 in bulk."""
LAYERED = 12
"""Particles with fewer next to them may be of a sheet; on the surface of bulk there are 13."""
LEAST = 4
"""Neighbours within reach that make a sheet of a particle; with fewer it is a drop or a thread."""
FLAT = 0.5
"""Thickness over extent, as standard deviations, below which it is a sheet: that of one layer is 0, of the half-space
below the surface of bulk 0.55."""
ROOM = 0.72
"""Distance that a new particle keeps from all others, in spacings: more than from the middle of a square of four to
its corners, or sheets that are not stretched would be filled too."""
SUPPORT = 2.0
"""Reach of the mean that flattens, in spacings: the support radius of the fluid."""
SHARE = 0.9
"""Of the way to that mean (Yu & Turk 2013)."""

Cloud = tuple[np.ndarray, np.ndarray]
"""Positions [m] and velocities [m/s], float32, shape [n, 3]."""


def whole_sheets(positions: np.ndarray, velocities: np.ndarray, spacing: float, spec: Sheets) -> Cloud:
    """The particles at `positions` [m] with `velocities` [m/s], float32, shape [n, 3], of `spacing` [m]: those of thin
    sheets moved into them, followed by the new ones that fill gaps of up to `spec.reach` spacings. Drops, threads and
    bulk stay as they are, to the last bit."""
    points = positions.astype(np.float64)
    sheet = np.flatnonzero(_flatness(points, spacing, spec.reach) < FLAT)
    first, second = _gaps(points, sheet, spacing, spec.reach)
    middle = (points[first] + points[second]) / 2
    moved = np.concatenate([sheet, len(points) + np.arange(len(middle))])
    filled = np.concatenate([points, middle])
    filled[moved] = _flattened(filled, moved, spacing)
    between = (velocities[first] + velocities[second]) / 2
    result = np.concatenate([positions, middle.astype(np.float32)])
    result[moved] = filled[moved]
    return result, np.concatenate([velocities, between.astype(np.float32)])


def _flatness(points: np.ndarray, spacing: float, reach: float) -> np.ndarray:
    """Of the cloud around each particle, the least over the greatest standard deviation, shape [n]: 0 in a plane, 1 in
    bulk. It is 1 too for threads, and where there are too many neighbours for a sheet, or too few."""
    flatness = np.ones(len(points))
    tree = KDTree(points)
    beside = tree.query_ball_point(points, NEXT * spacing, return_length=True) - 1
    some = np.flatnonzero(beside < LAYERED)
    radius = reach * spacing
    center, other, weight = _neighbours(points, some, tree, radius)
    way = points[other] - points[some[center]]
    count = np.bincount(center, minlength=len(some))
    total = np.bincount(center, weight, len(some))
    mean = _sums(center, weight[:, None] * way, len(some)) / total[:, None]
    off = way - mean[center]
    covariance = np.empty((len(some), 3, 3))
    for row in range(3):
        covariance[:, row] = _sums(center, (weight * off[:, row])[:, None] * off, len(some)) / total[:, None]
    deviation = np.sqrt(np.maximum(np.linalg.eigvalsh(covariance), 0.0))
    enough = (count > LEAST) & (deviation[:, 1] > FLAT * deviation[:, 2])
    flatness[some[enough]] = deviation[enough, 0] / deviation[enough, 2]
    return flatness


def _gaps(points: np.ndarray, thin: np.ndarray, spacing: float, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of particles of thin sheets with room for one between them, the nearest first, as two arrays."""
    pairs = KDTree(points[thin]).query_pairs(reach * spacing, output_type="ndarray")
    length = np.linalg.norm(points[thin[pairs[:, 0]]] - points[thin[pairs[:, 1]]], axis=1)
    wide = length > 2 * ROOM * spacing
    pairs, length = thin[pairs[wide]], length[wide]
    # equal lengths in the order of particles, for which a tree has none of its own
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0], length))]
    middle = points[pairs].mean(axis=1)
    nearest, _ = KDTree(points).query(middle, distance_upper_bound=ROOM * spacing)
    pairs, middle = pairs[nearest > ROOM * spacing], middle[nearest > ROOM * spacing]
    kept = _first_of_crowds(middle, ROOM * spacing)
    return pairs[kept, 0], pairs[kept, 1]


def _first_of_crowds(points: np.ndarray, distance: float) -> np.ndarray:
    """Which of `points` stay if each, in their order, drives away later ones that are nearer than `distance`."""
    kept = np.zeros(len(points), bool)
    undecided = np.ones(len(points), bool)
    close = KDTree(points).query_pairs(distance, output_type="ndarray") if len(points) else np.empty((0, 2), int)
    while undecided.any():
        after = np.zeros(len(points), bool)
        after[close[:, 1]] = True
        chosen = undecided & ~after
        kept |= chosen
        undecided &= ~chosen
        undecided[close[chosen[close[:, 0]], 1]] = False
        close = close[undecided[close].all(axis=1)]
    return kept


def _flattened(points: np.ndarray, which: np.ndarray, spacing: float) -> np.ndarray:
    """Where those `which` go: most of the way to the weighted mean around each, itself included."""
    center, other, weight = _neighbours(points, which, KDTree(points), SUPPORT * spacing)
    total = np.bincount(center, weight, len(which))
    mean = _sums(center, weight[:, None] * points[other], len(which)) / total[:, None]
    return (1 - SHARE) * points[which] + SHARE * mean


def _neighbours(
    points: np.ndarray, which: np.ndarray, tree: KDTree, radius: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of an index into `which` and a particle nearer than `radius`, itself too, and their weights 1 - (r/R)^3."""
    found = KDTree(points[which]).sparse_distance_matrix(tree, radius, output_type="ndarray")
    order = np.lexsort((found["j"], found["i"]))
    center, other, length = found["i"][order], found["j"][order], found["v"][order]
    return center, other, 1.0 - (length / radius) ** 3


def _sums(center: np.ndarray, vectors: np.ndarray, count: int) -> np.ndarray:
    """Of the vectors of each center, shape [count, 3]."""
    return np.stack([np.bincount(center, vectors[:, axis], count) for axis in range(3)], axis=1)
