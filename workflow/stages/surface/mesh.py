"""The mesh of a fluid's surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


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
