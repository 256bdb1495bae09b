"""What hangs together."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def groups(one: np.ndarray, other: np.ndarray, count: int) -> tuple[int, np.ndarray]:
    """How many groups `count` members form where each of `one` belongs to that of `other`, both of shape [links], and
    the group of each, shape [count]."""
    links = coo_array((np.ones(len(one)), (one, other)), shape=(count, count))
    return connected_components(links, directed=False)
