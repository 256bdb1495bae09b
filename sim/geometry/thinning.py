"""Clouds of points thinned until no two of them are close."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

FIRST, GROWTH = 1000, 4
"""Points that are thinned at a time: so many at first, then so many times as many as before."""


def first_come(points: np.ndarray, radius: float) -> np.ndarray:
    """Indices of a maximal subset with no two points within `radius`, earlier points first."""
    kept = np.empty(0, dtype=np.int64)
    start, size = 0, FIRST
    while start < len(points):
        # Most of those that come later are near one that is kept, and need not be compared with one another.
        some = np.arange(start, min(start + size, len(points)))
        if len(kept):
            away, _ = cKDTree(points[kept]).query(points[some], distance_upper_bound=np.nextafter(radius, np.inf))
            some = some[np.isinf(away)]
        kept = np.concatenate((kept, some[_first_come(points[some], radius)]))
        start, size = start + size, GROWTH * size
    return kept


def _first_come(points: np.ndarray, radius: float) -> np.ndarray:
    pairs = cKDTree(points).query_pairs(radius, output_type="ndarray")
    undecided = np.ones(len(points), dtype=bool)
    kept = np.zeros(len(points), dtype=bool)
    while undecided.any():
        # query_pairs returns i < j: j waits while an earlier neighbour may still be kept.
        pairs = pairs[undecided[pairs].all(axis=1)]
        waiting = np.zeros(len(points), dtype=bool)
        waiting[pairs[:, 1]] = True
        chosen = undecided & ~waiting
        kept |= chosen
        undecided &= ~chosen
        undecided[pairs[chosen[pairs[:, 0]], 1]] = False
    return np.flatnonzero(kept)
