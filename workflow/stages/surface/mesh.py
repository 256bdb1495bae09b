"""The mesh of a fluid's surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix


@dataclass(frozen=True)
class Surface:
    """A closed triangle mesh."""

    vertices: np.ndarray
    """Positions [m], float32, shape [n, 3]."""
    normals: np.ndarray
    """Unit vectors out of the fluid, float32, shape [n, 3]."""
    velocities: np.ndarray
    """Of the fluid at the vertices [m/s], float32, shape [n, 3]."""
    triangles: np.ndarray
    """Indices of vertices, counter-clockwise from outside, int32, shape [m, 3]."""

    @classmethod
    def empty(cls) -> Surface:
        """That of no fluid."""
        nothing = np.empty((0, 3), np.float32)
        return cls(nothing, nothing, nothing, np.empty((0, 3), np.int32))

    def __add__(self, other: Surface) -> Surface:
        """Both, side by side."""
        return Surface(
            np.concatenate([self.vertices, other.vertices]),
            np.concatenate([self.normals, other.normals]),
            np.concatenate([self.velocities, other.velocities]),
            np.concatenate([self.triangles, other.triangles + np.int32(len(self.vertices))]),
        )

    @property
    def volume(self) -> float:
        """Enclosed volume [m^3]."""
        place = self.vertices.astype(np.float64)
        return float(volumes(place, self.triangles, np.zeros(len(self.triangles), int), 1)[0])


def volumes(place: np.ndarray, triangles: np.ndarray, piece: np.ndarray, count: int) -> np.ndarray:
    """What pieces of a mesh enclose [m^3], shape [count], by the divergence theorem; `place` of vertices [m], `piece`
    of each triangle."""
    if not len(triangles):
        return np.zeros(count)
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = np.moveaxis((place - place.mean(axis=0))[triangles], 0, 2)
    each = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return np.bincount(piece, each / 6.0, count)


def area_normals(place: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Of vertices at `place` [m], the sum of the areas of their triangles as vectors out of the fluid, a third of each
    [m^2], shape [n, 3]: by how much a mesh grows as they move."""
    x, y, z = np.ascontiguousarray(place.T, np.float64)
    a, b, c = triangles.T
    ux, uy, uz = x[b] - x[a], y[b] - y[a], z[b] - z[a]
    vx, vy, vz = x[c] - x[a], y[c] - y[a], z[c] - z[a]
    normal = np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], axis=1)
    return at_corners(normal / 6.0, triangles, len(place))


def unit_normals(surface: Surface, area: np.ndarray) -> np.ndarray:
    """Of the vertices of the mesh itself, whose area normals are `area` [m^2]: those that it is drawn with may be
    smoother. Shape [n, 3]."""
    size = np.linalg.norm(area, axis=1, keepdims=True)
    return np.where(size > 0, area / np.maximum(size, np.finfo(float).tiny), surface.normals)


def at_corners(vectors: np.ndarray, triangles: np.ndarray, count: int) -> np.ndarray:
    """Sums of the vectors of triangles, shape [m, 3], at `count` vertices; shape [count, 3]."""
    return np.stack([_at_corners(vectors[:, axis], triangles, count) for axis in range(3)], axis=1)


def _at_corners(values: np.ndarray, triangles: np.ndarray, count: int) -> np.ndarray:
    return sum((np.bincount(corner, values, count) for corner in triangles.T), np.zeros(count))


def sums(index: np.ndarray, vectors: np.ndarray, count: int) -> np.ndarray:
    """Of the vectors, shape [k, 3], with each index below `count`; shape [count, 3]."""
    return np.stack([np.bincount(index, vectors[:, axis], count) for axis in range(3)], axis=1)


class Smoothing:
    """Means over the vertices that a mesh of `triangles` with `count` vertices links to each, and itself."""

    def __init__(self, triangles: np.ndarray, count: int):
        first, second = triangles.ravel(), np.roll(triangles, 1, axis=1).ravel()
        links = coo_matrix((np.ones(len(first), np.float32), (first, second)), shape=(count, count)).tocsr()
        self._links = links + links.T
        self._share = 1.0 / (1.0 + np.asarray(self._links.sum(axis=1), np.float32).ravel())

    def mean(self, values: np.ndarray, rounds: int) -> np.ndarray:
        """Of `values` of the vertices, shape [count] or [count, k], taken `rounds` times, in float32: they spread as by
        diffusion, over the square root of that number of edges."""
        share, values = self._share.reshape(-1, *[1] * (values.ndim - 1)), values.astype(np.float32)
        for _ in range(rounds):
            values = (values + self._links @ values) * share
        return values
