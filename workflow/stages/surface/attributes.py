"""What the fluid does at the vertices of its surface: means of the particles around, for looks and other programs.

A mean weighted by a kernel and normalised (Shepard 1968) is right where few particles are near, too. Vorticity is the
curl of the velocity by SPH with corrected gradients (Bonet & Lok 1999), which is that of a rigid rotation also at a
free surface, where uncorrected ones see half of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from scipy.spatial import KDTree

REACH = 2.0
"""Radius of the kernel, in spacings: the support radius of the fluid."""
NEAREST = 40
"""Particles of which a mean is taken, at most: 33 are within reach in bulk."""
FLAT = 0.05
"""Of the greatest extent of what is around a particle, below which a direction has no gradient: that across a sheet."""
TOGETHER = 65_536
"""Places that are looked at at once, which bounds memory."""


def sampled(
    names: Sequence[str],
    vertices: np.ndarray,
    positions: np.ndarray,
    velocities: np.ndarray,
    known: Mapping[str, np.ndarray],
    spacing: float,
) -> dict[str, np.ndarray]:
    """What is named at vertices [m], shape [m, 3], each float32, shape [m].

    positions [m] and velocities [m/s], float32, shape [n, 3], are those of the particles; `known`: what else is known
    of them, by name, shape [n] each.
    """
    if not names:
        return {}
    if not len(positions) or not len(vertices):
        return {name: np.zeros(len(vertices), np.float32) for name in names}
    tree = KDTree(positions.astype(np.float64))
    values = {
        "speed": lambda: np.linalg.norm(velocities.astype(np.float64), axis=1),
        "vorticity": lambda: _vorticity(tree, vertices.astype(np.float64), velocities.astype(np.float64), spacing),
    }
    table = np.stack([known[name] if name in known else values[name]() for name in names], axis=1, dtype=np.float64)
    means = np.concatenate([_mean(table, *near) for _, near in _around(tree, vertices.astype(np.float64), spacing)])
    return {name: means[:, column].astype(np.float32) for column, name in enumerate(names)}


def _vorticity(tree: KDTree, vertices: np.ndarray, velocities: np.ndarray, spacing: float) -> np.ndarray:
    """Magnitude of the vorticity [1/s] of the particles that count at vertices, and 0 of others, shape [n]."""
    points = np.asarray(tree.data)
    away, _ = KDTree(vertices).query(points, distance_upper_bound=REACH * spacing)
    counts = np.isfinite(away)
    counts[tree.query(vertices)[1]] = True
    found = np.zeros(len(points))
    found[counts] = np.linalg.norm(curl(tree, velocities, spacing, np.flatnonzero(counts)), axis=1)
    return found


def curl(tree: KDTree, velocities: np.ndarray, spacing: float, which: np.ndarray) -> np.ndarray:
    """Vorticity [1/s] of some particles, shape [k, 3]: those `which` of a tree, where the velocities [m/s] of all are
    given, shape [n, 3]."""
    points = np.asarray(tree.data)
    found = np.empty((len(which), 3))
    for rows, (other, away) in _around(tree, points[which], spacing):
        center = which[rows, None]
        # minus the slope of the kernel (1 - q^2)^3 over q
        weight = np.maximum(1.0 - away**2, 0.0) ** 2
        way = (points[other] - points[center]) / spacing
        change = velocities[other] - velocities[center]
        shape = np.einsum("nk,nki,nkj->nij", weight, way, way)
        slope = np.einsum("nk,nki,nkj->nij", weight, change, way) / spacing
        gradient = slope @ np.linalg.pinv(shape, rcond=FLAT, hermitian=True)
        for axis, (first, second) in enumerate(((2, 1), (0, 2), (1, 0))):
            found[rows, axis] = gradient[:, first, second] - gradient[:, second, first]
    return found


def _around(tree: KDTree, places: np.ndarray, spacing: float) -> Iterator[tuple[slice, tuple[np.ndarray, np.ndarray]]]:
    """Of some of the places [m] after others: the nearest particles, and how far they are, over the radius of the
    kernel; both of shape [k, NEAREST]."""
    for start in range(0, max(len(places), 1), TOGETHER):
        rows = slice(start, start + TOGETHER)
        away, other = tree.query(places[rows], min(NEAREST, tree.n))
        yield rows, (other.reshape(len(away), -1), away.reshape(len(away), -1) / (REACH * spacing))


def _mean(table: np.ndarray, other: np.ndarray, away: np.ndarray) -> np.ndarray:
    """Means of the rows of a table at places; where no particle is within reach, the nearest has its own."""
    weight = np.maximum(1.0 - away**2, 0.0) ** 3
    weight[:, :1] = np.where(weight.any(axis=1, keepdims=True), weight[:, :1], 1.0)
    return np.einsum("nk,nkc->nc", weight, table[other]) / weight.sum(axis=1)[:, None]
