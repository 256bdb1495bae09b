"""Closest points on triangle meshes."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

if TYPE_CHECKING:
    import trimesh

# How many points stand for the surface in the search tree; more points, fewer candidate triangles.
_COVER_POINTS = 100_000
_FEW_POINTS = 5_000
_NEIGHBOURS = (8, 32)
# Cover radii from the surface beyond which the first candidates are near enough to the best.
_FAR = 10.0
_QUERIES_AT_ONCE = 1_000_000


class MeshDistance:
    """Distances to the surface of a mesh.

    Every triangle is covered by points no further apart than a cover radius rho, which a k-d tree holds. The
    triangles of the k = 8 nearest points are tried exactly; the answer d is final when the k-th point is further
    than d + rho, else 32 are tried. From 10 rho on, 8 serve: the answer is then high by less than rho^2 / (2 d),
    0.5 % of d.
    """

    def __init__(self, mesh: trimesh.Trimesh, *, cover_points: int = _COVER_POINTS):
        """With fewer `cover_points` more triangles are tried, and points deep inside are soon compared with all."""
        self._corners = np.array(mesh.vertices, dtype=np.float64)[mesh.faces]
        points, self._face, self._radius = cover(self._corners, cover_points)
        self._tree = cKDTree(points)

    def closest(self, points: np.ndarray, *, sure: bool = True) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Closest points of the surface [m], shape [n, 3], distances [m], shape [n], and faces, shape [n].

        Without `sure` the first candidates do: a fraction of the cost, and the answer is high by less than
        rho^2 / (2 d) everywhere.
        """
        points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        foot = np.empty_like(points)
        distance = np.full(len(points), np.inf)
        face = np.zeros(len(points), dtype=np.int64)
        open_queries = np.arange(len(points))
        for neighbours in _NEIGHBOURS:
            neighbours = min(neighbours, self._tree.n)
            undecided = []
            portion = max(1, _QUERIES_AT_ONCE // neighbours)
            for start in range(0, len(open_queries), portion):
                query = open_queries[start : start + portion]
                reach, near = self._tree.query(points[query], k=neighbours)
                reach, near = reach.reshape(len(query), -1), near.reshape(len(query), -1)
                candidates = self._face[near]
                feet = closest_on_triangles(
                    np.repeat(points[query], neighbours, axis=0), self._corners[candidates.reshape(-1)]
                ).reshape(len(query), neighbours, 3)
                lengths = np.linalg.norm(feet - points[query, None], axis=2)
                best = lengths.argmin(axis=1)
                row = np.arange(len(query))
                foot[query], distance[query] = feet[row, best], lengths[row, best]
                face[query] = candidates[row, best]
                if sure and neighbours < self._tree.n:
                    near_surface = distance[query] < _FAR * self._radius
                    undecided.append(query[near_surface & (reach[:, -1] < distance[query] + self._radius)])
            open_queries = np.concatenate(undecided) if undecided else np.empty(0, dtype=np.int64)
            if len(open_queries) == 0:
                break
        return foot, distance, face

    def within(self, points: np.ndarray, reach: float) -> np.ndarray:
        """The indices of all points [m], shape [n, 3], that are nearer than `reach` [m], and of some others."""
        tree, radius = self._rough
        nearest, _ = tree.query(points, distance_upper_bound=reach + radius)
        return np.flatnonzero(np.isfinite(nearest))

    @functools.cached_property
    def _rough(self) -> tuple[cKDTree, float]:
        """Few points that cover the surface, which points as far from many of them as from one are soon compared
        with, and their cover radius [m]."""
        points, _, radius = cover(self._corners, _FEW_POINTS)
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


def closest_on_triangles(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The point of each triangle, shape [n, 3, 3], nearest to each point, shape [n, 3]: Ericson 2005, sec. 5.1.5."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, ac, ap = b - a, c - a, points - a
    dot = _rowwise_dot
    d1, d2 = dot(ab, ap), dot(ac, ap)
    bp, cp = points - b, points - c
    d3, d4 = dot(ab, bp), dot(ac, bp)
    d5, d6 = dot(ab, cp), dot(ac, cp)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = 1.0 / (va + vb + vc)
        v, w = vb * inside, vc * inside
        regions = [
            ((d1 <= 0) & (d2 <= 0), 0.0, 0.0),
            ((d3 >= 0) & (d4 <= d3), 1.0, 0.0),
            ((vc <= 0) & (d1 >= 0) & (d3 <= 0), d1 / (d1 - d3), 0.0),
            ((d6 >= 0) & (d5 <= d6), 0.0, 1.0),
            ((vb <= 0) & (d2 >= 0) & (d6 <= 0), 0.0, d2 / (d2 - d6)),
        ]
        along = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        regions.append(((va <= 0) & (d4 >= d3) & (d5 >= d6), 1.0 - along, along))
    for region, in_b, in_c in reversed(regions):
        v, w = np.where(region, in_b, v), np.where(region, in_c, w)
    # A triangle without area, left to no region by rounding: its corner is as good.
    v, w = np.nan_to_num(v, nan=0.0, posinf=0.0, neginf=0.0), np.nan_to_num(w, nan=0.0, posinf=0.0, neginf=0.0)
    return a + v[:, None] * ab + w[:, None] * ac


def _rowwise_dot(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", u, v)


def _subtriangle_centroids(cuts: int) -> np.ndarray:
    """Barycentric coordinates of the centroids of the cuts^2 similar parts of a triangle."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(cuts), np.arange(cuts), indexing="ij"))
    upright = i + j < cuts
    inverse = i + j < cuts - 1
    u = np.concatenate([i[upright] + 1 / 3, i[inverse] + 2 / 3]) / cuts
    v = np.concatenate([j[upright] + 1 / 3, j[inverse] + 2 / 3]) / cuts
    return np.column_stack([1 - u - v, u, v])
