"""The part of a cloth's stiffness that is alike along all axes: the bending of shells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class BendingRows:
    """How bending pushes points back along each axis, by rows of points, without the diagonal."""

    first: np.ndarray
    """Where entries of each row begin, shape [n + 1]."""
    column: np.ndarray
    stiffness: np.ndarray
    """[N/m], shape [entries]."""
    diagonal: np.ndarray
    """[N/m], shape [n]."""

    @staticmethod
    def none(count: int) -> BendingRows:
        """Of cloth of so many points without a shell."""
        return BendingRows(np.zeros(count + 1, int), np.zeros(0, int), np.zeros(0), np.zeros(count))
