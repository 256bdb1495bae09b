"""Closest points on triangle meshes."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

if TYPE_CHECKING:
    import trimesh

# Of the points that cover a surface, to tell roughly what is near it.
_FEW_POINTS = 5_000


class MeshDistance:
    """Distances to the surface of a mesh, by the tree of boxes of libigl."""

    def __init__(self, mesh: trimesh.Trimesh):
        # A scene without meshes loads nothing of this.
        import igl

        self._vertices = np.ascontiguousarray(mesh.vertices, dtype=np.float64)
        self._faces = np.ascontiguousarray(mesh.faces, dtype=np.int64)
        self._tree = igl.AABB()
        self._tree.init(self._vertices, self._faces)

    def closest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Closest points of the surface [m], shape [n, 3], distances [m], shape [n], and faces, shape [n].

        Raises ValueError for points that are not finite: libigl would name the origin.
        """
        points = np.ascontiguousarray(points, dtype=np.float64).reshape(-1, 3)
        if not np.isfinite(points).all():
            raise ValueError("points have to be finite")
        squared, face, foot = self._tree.squared_distance(self._vertices, self._faces, points)
        return foot.reshape(-1, 3), np.sqrt(squared), face

    def within(self, points: np.ndarray, reach: float) -> np.ndarray:
        """The indices of all points [m], shape [n, 3], that are nearer than `reach` [m], and of some others."""
        tree, radius = self._rough
        nearest, _ = tree.query(points, distance_upper_bound=reach + radius)
        return np.flatnonzero(np.isfinite(nearest))

    @functools.cached_property
    def _rough(self) -> tuple[cKDTree, float]:
        """Few points that cover the surface, which points as far from many of them as from one are soon compared
        with, and their cover radius [m]."""
        points, _, radius = cover(self._vertices[self._faces], _FEW_POINTS)
        return cKDTree(points), radius

    def unsigned(self, points: np.ndarray) -> np.ndarray:
        """Distances [m] from points [m], shape [n, 3]; shape [n]."""
        return self.closest(points)[1]


def cover(corners: np.ndarray, number: int) -> tuple[np.ndarray, np.ndarray, float]:
    """About `number` points or two a triangle that cover triangles: points, their triangle, the radius that covers.

    `corners` has shape [faces, 3, 3]. Triangles with an edge longer than a common length are cut into n^2 similar
    ones, whose centroids are the points.
    """
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    length = 2.0 * np.sqrt(area / number)
    cuts = np.maximum(1, np.ceil(edges / length)).astype(np.int64)
    # Needles would need a point every `length` in both directions: bound what they may cost.
    while (cuts**2).sum() > 8 * number + 2 * len(corners):
        length *= 1.5
        cuts = np.maximum(1, np.ceil(edges / length)).astype(np.int64)
    points, faces = [], []
    for cut in np.unique(cuts):
        chosen = np.flatnonzero(cuts == cut)
        weights = _subtriangle_centroids(int(cut))
        points.append(np.einsum("wk,fkx->fwx", weights, corners[chosen]).reshape(-1, 3))
        faces.append(np.repeat(chosen, len(weights)))
    # A point of a triangle is within 2/3 of its longest edge of the centroid (the longest median is shorter).
    return np.concatenate(points), np.concatenate(faces), float((edges / cuts).max() * 2 / 3)


def _subtriangle_centroids(cuts: int) -> np.ndarray:
    """Barycentric coordinates of the centroids of the cuts^2 similar parts of a triangle."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(cuts), np.arange(cuts), indexing="ij"))
    upright = i + j < cuts
    inverse = i + j < cuts - 1
    u = np.concatenate([i[upright] + 1 / 3, i[inverse] + 2 / 3]) / cuts
    v = np.concatenate([j[upright] + 1 / 3, j[inverse] + 2 / 3]) / cuts
    return np.column_stack([1 - u - v, u, v])
