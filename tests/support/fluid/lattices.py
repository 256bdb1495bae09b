"""Particles in rows."""

from __future__ import annotations

import numpy as np


def lattice(*counts: int) -> np.ndarray:
    """The points of whole coordinates from 0 to below each count; shape [product of counts, number of counts]."""
    axes = np.meshgrid(*map(np.arange, counts), indexing="ij")
    return np.stack(axes, axis=-1).reshape(-1, len(counts))
