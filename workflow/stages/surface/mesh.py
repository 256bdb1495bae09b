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
        """Enclosed volume [m^3], by the divergence theorem."""
        if not len(self.triangles):
            return 0.0
        origin = self.vertices.mean(axis=0, dtype=np.float64)
        a, b, c = np.moveaxis(self.vertices[self.triangles].astype(np.float64) - origin, 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)
