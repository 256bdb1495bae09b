"""Meshes of bodies and vessels as a film has them, for what its frames become: foam and the surface of the fluid."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.distance.closest_points import MeshDistance
from sim.geometry.pose import Pose
from sim.geometry.solids import MeshSolid

if TYPE_CHECKING:
    import trimesh


class Body:
    """The inside of a closed mesh, whose vertices [m] are relative to its motion's position."""

    def __init__(self, mesh: trimesh.Trimesh, *, closed: bool = True):
        """closed: without it, the mesh has no inside, as that of a vessel has none."""
        self._solid = MeshSolid(Pose(), mesh)
        self._low, self._high = self._solid.bounds
        self._closed = closed

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Whether points [m], shape [n, 3], are inside; shape [n]."""
        if not self._closed:
            return np.zeros(len(points), bool)
        inside = ((points > self._low) & (points < self._high)).all(axis=1)
        inside[inside] = self._solid.contains(points[inside])
        return inside

    @cached_property
    def _surface(self) -> MeshDistance:
        return MeshDistance(self._solid.surface)

    def nearest(self, points: np.ndarray) -> np.ndarray:
        """The points of the surface [m] next to points [m]; shape [n, 3]."""
        return self._surface.closest(points)[0]

    def touching(self, points: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Indices of points [m], shape [n, 3], that are outside, but nearer than `reach` [m], and the points of the
        surface next to them [m], shape [k, 3]."""
        near = np.flatnonzero(((points > self._low - reach) & (points < self._high + reach)).all(axis=1))
        foot, distance, _ = self._surface.closest(points[near])
        near, foot = near[distance < reach], foot[distance < reach]
        outside = ~self.contains(points[near])
        return near[outside], foot[outside]
