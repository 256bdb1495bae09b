"""Pieces of cloth that nothing holds: no forces that a solution leaves push them as a whole, and gravity as it should.

Springs, hinges and contacts between pieces act on both of their sides alike, so that the sum of the forces left on what
hangs together, and touches nothing else, is an error of its momentum. Moved by as much, nothing in it changes. What
falls goes exactly as far as it should when as a whole it goes with the mean of its velocities before and after a step.
"""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.contact_set import ContactSet
from sim.cloth.contact.detection.search import PLANE
from sim.cloth.fabric.mesh import ClothMesh
from sim.device.compiler import ti
from sim.free_fall import OTHERS
from sim.geometry.components import groups


class FreePieces:
    """The pieces of a cloth, by its springs. `free`: 1 for points that are tied to no held one, shape [points]; `any`:
    whether there are such."""

    def __init__(self, mesh: ClothMesh):
        self._count, self._mass = mesh.count, mesh.mass
        self._pieces, self._piece = groups(mesh.edges[:, 0], mesh.edges[:, 1], mesh.count)
        self._held = np.isin(np.arange(self._pieces), self._piece[mesh.held])
        self.free = 1.0 - self._held[self._piece]
        self.any = not self._held.all()

    def push(self, contacts: ContactSet, force: ti.Ndarray) -> np.ndarray | None:
        """The acceleration [m/s^2] that forces left on points [N] are for all that is adrift and touches nothing else,
        0 elsewhere, shape [points, 3]; None where nothing is."""
        system, alone = self._systems(contacts)
        return np.where(alone, self._mean(system, force.to_numpy()[: self._count]), 0.0) if alone.any() else None

    def falling(self, contacts: ContactSet, gravity: np.ndarray, change: np.ndarray) -> np.ndarray | None:
        """To which share all that is adrift and touches nothing else falls freely, by the change of the velocities of
        points in a step over its length [m/s^2], shape [points, 3]; 0 elsewhere, shape [points, 1]. None where nothing
        falls."""
        g = np.linalg.norm(gravity)
        if g == 0:
            return None
        system, alone = self._systems(contacts)
        if not alone.any():
            return None
        others = np.linalg.norm(self._mean(system, self._mass[:, None] * change) - gravity, axis=1, keepdims=True)
        share = np.where(alone, np.maximum(1.0 - others / (OTHERS * g), 0.0), 0.0)
        return share if share.any() else None

    def _systems(self, contacts: ContactSet) -> tuple[np.ndarray, np.ndarray]:
        """Of points, the system of pieces that touch one another, shape [points], and whether it is adrift and touches
        nothing else, shape [points, 1]."""
        fixed, corners = self._held.copy(), contacts.key[:, 1:]
        others = (contacts.key[:, 0] >= PLANE) | (corners >= self._count).any(axis=1)
        fixed[self._of(corners[others])] = True
        system, between = self._piece, corners[~others]
        if self._pieces > 1 and len(between):
            count, found = groups(self._piece[between[:, 0]], self._piece[between[:, 3]], self._pieces)
            fixed, system = np.isin(np.arange(count), found[fixed]), found[self._piece]
        return system, ~fixed[system, None]

    def _mean(self, system: np.ndarray, force: np.ndarray) -> np.ndarray:
        """The acceleration of the system of each point by forces on points [N], shape [points, 3]."""
        total = np.column_stack([np.bincount(system, one) for one in force.T])
        return (total / np.bincount(system, self._mass)[:, None])[system]

    def _of(self, corners: np.ndarray) -> np.ndarray:
        """Pieces that points of contacts belong to."""
        return np.unique(self._piece[corners[(corners >= 0) & (corners < self._count)]])
