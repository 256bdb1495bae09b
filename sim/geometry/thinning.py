"""Clouds of points thinned until no two of them are close."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree


def first_come(points: np.ndarray, radius: float) -> np.ndarray:
    """Indices of a maximal subset with no two points within `radius`, earlier points first."""
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
