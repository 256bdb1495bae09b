"""Solids in which no cloth can be."""

from __future__ import annotations

import functools

import numpy as np
import trimesh

from sim.cloth.contact.solids import Solids
from sim.cloth.untangling.casting import cast
from sim.geometry.distance.closest_points import MeshDistance
from sim.geometry.meshes.winding import WindingNumber

OUTWARD = np.concatenate([np.eye(3)[[1, 0, 2]], -np.eye(3)])
"""Ways that may lead out, upward first."""


class Filled:
    """A body with a closed surface."""

    def __init__(self, solids: Solids, body: int):
        self.name = solids.names[body]
        faces = solids.triangles[solids.body[solids.triangles[:, 0]] == body]
        self._mesh = trimesh.Trimesh(solids.points, faces, process=False)
        corners = solids.points[faces]
        self._low, self._high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))

    @functools.cached_property
    def _winding(self) -> WindingNumber:
        return WindingNumber(self._mesh)

    @functools.cached_property
    def _distance(self) -> MeshDistance:
        return MeshDistance(self._mesh)

    def holds(self, points: np.ndarray, depth: float) -> np.ndarray:
        """Whether points [m], shape [n, 3], are inside by more than `depth` [m], shape [n]."""
        found = ((points > self._low) & (points < self._high)).all(axis=1)
        if found.any():
            found[found] = self._winding.at(points[found]) > 0
        if found.any():
            found[found] = self._distance.unsigned(points[found]) > depth
        return found

    def way_out(self, points: np.ndarray) -> np.ndarray:
        """The shortest way [m] along an axis on which all points, shape [n, 3], come out, shape [3]."""
        corners = self._mesh.vertices[self._mesh.faces]
        ways_out = [
            cast(points, corners, direction, last=True)[3].max(initial=0.0) * direction for direction in OUTWARD
        ]
        return min(ways_out, key=np.linalg.norm)
