"""Which edges go through which triangles: the linear system of every pair, solved with numpy.

Independent of the simulation's own search, which decides by signs.
"""

from __future__ import annotations

import numpy as np

from tests.support.passing import edges_of


def crossed(places: np.ndarray, triangles: np.ndarray, cloth: np.ndarray | None = None, *, portion: int = 400) -> int:
    """How many edges go through triangles that they have no point in common with, for points at `places` [m], shape
    [n, 3]; `cloth`: which points are cloth, pairs without any do not count (default: all)."""
    cloth = np.ones(len(places), bool) if cloth is None else cloth
    edges = edges_of(triangles)
    of_cloth = cloth[edges].any(axis=1)
    return _crossed(places, edges[of_cloth], triangles, portion) + _crossed(
        places, edges[~of_cloth], triangles[cloth[triangles].any(axis=1)], portion
    )


def _crossed(places: np.ndarray, edges: np.ndarray, triangles: np.ndarray, portion: int) -> int:
    corners = places[triangles]
    low, high, count = corners.min(axis=1), corners.max(axis=1), 0
    for start in range(0, len(edges), portion):
        ends = edges[start : start + portion]
        p, q = places[ends[:, 0]], places[ends[:, 1]]
        near = (np.minimum(p, q)[:, None] <= high).all(axis=2) & (low <= np.maximum(p, q)[:, None]).all(axis=2)
        row, face = np.nonzero(near)
        apart = (ends[row][:, :, None] != triangles[face][:, None]).all(axis=(1, 2))
        row, face = row[apart], face[apart]
        a, b, c = (corners[face, k] for k in range(3))
        matrix = np.stack([p[row] - q[row], b - a, c - a], axis=-1)
        solvable = np.abs(np.linalg.det(matrix)) > 1e-14 * np.abs(matrix).max(axis=(1, 2), initial=0) ** 3
        share, u, v = np.linalg.solve(matrix[solvable], (p[row] - a)[solvable][..., None])[..., 0].T
        count += int(((share >= 0) & (share <= 1) & (u >= 0) & (v >= 0) & (u + v <= 1)).sum())
    return count
