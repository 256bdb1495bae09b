"""Pieces of cloth that nothing holds: what forces a solution leaves may not push them as a whole.

Springs, hinges and contacts between pieces act on both of their sides alike, so that the sum of the forces left on what
hangs together, and touches nothing else, is an error of its momentum. Moved by as much, nothing in it changes.
"""

from __future__ import annotations

import numpy as np
import taichi as ti

from sim.cloth.collision import Known
from sim.cloth.mesh import ClothMesh
from sim.cloth.search import PLANE
from sim.groups import groups


class Adrift:
    """The pieces of a cloth, by its springs. `free`: 1 for points that are tied to no held one, shape [points]."""

    def __init__(self, mesh: ClothMesh):
        self._count, self._mass = mesh.count, mesh.mass
        self._pieces, self._piece = groups(mesh.ends[:, 0], mesh.ends[:, 1], mesh.count)
        self._held = np.isin(np.arange(self._pieces), self._piece[mesh.held])
        self.free = 1.0 - self._held[self._piece]

    def push(self, contacts: Known, force: ti.Ndarray) -> np.ndarray | None:
        """The acceleration [m/s^2] that forces left on points [N] are for all that is adrift and touches nothing else,
        0 elsewhere, shape [points, 3]; None where nothing is."""
        fixed, corners = self._held.copy(), contacts.key[:, 1:]
        others = (contacts.key[:, 0] >= PLANE) | (corners >= self._count).any(axis=1)
        fixed[self._of(corners[others])] = True
        if fixed.all():
            return None
        system, between = self._piece, corners[~others]
        if self._pieces > 1 and len(between):
            count, found = groups(*(self._piece[between[:, k]] for k in (0, 3)), self._pieces)
            fixed, system = np.isin(np.arange(count), found[fixed]), found[self._piece]
        mass = np.bincount(system, self._mass)[:, None]
        total = np.column_stack([np.bincount(system, one) for one in force.to_numpy()[: self._count].T])
        return np.where(fixed[:, None], 0.0, total / mass)[system]

    def _of(self, corners: np.ndarray) -> np.ndarray:
        """Pieces that points of contacts belong to."""
        return np.unique(self._piece[corners[(corners >= 0) & (corners < self._count)]])
