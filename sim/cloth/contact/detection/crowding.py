"""Pairs of one piece of cloth that are nearer to each other at rest than the cloth is thick.

They would count as touching while the cloth is flat, and hold it flat. They touch at a share of their distance at rest
instead, so that cloth bends however fine it is; what is farther apart along the cloth keeps its thickness.
"""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.detection import search
from sim.cloth.contact.detection.search import AT_REST, PLANE
from sim.cloth.fabric.arrays import vectors
from sim.cloth.fabric.mesh import ClothMesh
from sim.geometry.components import groups

APART = 1e3
"""Between pieces, so that they are never near each other at rest [m]."""
SPARE = 0.8
"""Primitives without a common point may be a little nearer than the lowest triangle is high."""


class Crowding:
    """Distances at rest. `present`: whether they matter, which they do not where triangles are high enough; `places`,
    of points at rest and of solids as placed [m], are there only if so."""

    def __init__(self, mesh: ClothMesh, half: np.ndarray):
        self._count = mesh.count
        corner = mesh.placed[mesh.triangles]
        sides = corner - np.roll(corner, 1, axis=1)
        twice_area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        height = twice_area / np.linalg.norm(sides, axis=2).max(axis=1)
        thickness = 2 * half[mesh.triangles].max(axis=1)
        self.present = bool((AT_REST * SPARE * height < thickness).any())
        if not self.present:
            return
        _, piece = groups(mesh.triangles.ravel(), np.roll(mesh.triangles, 1, axis=1).ravel(), mesh.count)
        places = mesh.placed.copy()
        places[: mesh.count, 0] += APART * piece
        self.places = vectors(places)

    def thickness(self, key: np.ndarray, otherwise: np.ndarray) -> np.ndarray:
        """At which distance pairs touch [m], each a kind and four points, where others touch at `otherwise`."""
        if not self.present:
            return otherwise
        pairs = np.flatnonzero((key[:, 0] < PLANE) & (key[:, 1:] < self._count).all(axis=1))
        if not len(pairs):
            return otherwise
        apart, normal, weight = np.zeros(len(pairs)), np.zeros((len(pairs), 3)), np.zeros((len(pairs), 4))
        search.look_again(len(pairs), np.ascontiguousarray(key[pairs]), self.places, apart, normal, weight)
        found = otherwise.copy()
        found[pairs] = np.minimum(otherwise[pairs], AT_REST * apart)
        return found
