"""How far points are from surfaces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Gap:
    """How far points are from one surface.

    rows: which points are meant, shape [n]; width: of the gap to the surface [m], negative beyond it, shape [n]; away:
    unit vectors along which it grows, shape [n, 3].
    """

    rows: np.ndarray
    width: np.ndarray
    away: np.ndarray

    def joined(self, other: Gap) -> Gap:
        """With the rows of another behind its own."""
        return Gap(*(np.concatenate(pair) for pair in zip(vars(self).values(), vars(other).values(), strict=True)))

    def where(self, mask: np.ndarray) -> Gap:
        """Those of the points for which a mask over all points, shape [m], holds."""
        kept = mask[self.rows]
        return Gap(self.rows[kept], self.width[kept], self.away[kept])


Gaps = Callable[[np.ndarray, float], Sequence[Gap]]
"""The gaps of points [m], shape [n, 3], to all surfaces that are nearer than a reach [m] or that the points are beyond;
as many each time, in the same order."""
