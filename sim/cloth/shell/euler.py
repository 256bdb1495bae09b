"""Symplectic Euler for a shell."""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.integrators.symplectic_euler import SymplecticEuler
from sim.cloth.shell import euler_sums
from sim.cloth.shell.newton import trial_arrays
from sim.cloth.shell.shell import shell_of
from sim.cloth.spec import Cloth


class ShellEuler(SymplecticEuler):
    """The same small steps, with the forces of a shell."""

    def __init__(self, mesh: ClothMesh, gravity: np.ndarray, settings: Cloth, collisions: Collisions):
        super().__init__(mesh, gravity, settings, collisions)
        self._shell = shell_of(mesh)
        self._trial = trial_arrays(self._shell)

    def run(self, dt: float, number: int) -> None:
        """Take so many small steps of dt [s], however unstable."""
        mesh, motion = self.mesh, self.motion
        rest, points = mesh.shell_rest, mesh.points
        for left in range(number, 0, -1):
            euler_sums.assess(self._shell.triangles, mesh.count, points, rest, self._trial)
            euler_sums.find_momentum(mesh.count, dt, self.gravity, points, rest, self._trial, motion)
            euler_sums.advance(mesh.air.present, mesh.count, dt, left, mesh.air.wind, points, mesh.air.drag, motion)
            self.project_contacts(dt, number, left)

    @property
    def bytes(self) -> int:
        return super().bytes + 8 * (24 * self._shell.triangles + 15 * self.mesh.count)
