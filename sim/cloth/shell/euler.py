"""Symplectic Euler for a shell."""

from __future__ import annotations

import math

import numpy as np

from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.energy import Meter
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
        self._trial, self._meter = trial_arrays(self._shell), Meter(mesh)

    def run(self, dt: float, number: int) -> None:
        """Take so many small steps of dt [s], however unstable."""
        mesh, air, free = self.mesh, self.mesh.air, self.alone and not self.collisions.count
        tables = mesh.points, air.drag, mesh.shell_rest, self._trial, self.motion
        counts = self._shell.triangles, mesh.count
        for step in range(1 if free else number):
            left = number - step
            euler_sums.step(free, air.present, number, left, *counts, dt, self.gravity, air.wind, *tables)
            self.project_contacts(dt, number, left)

    def substeps(self, dt: float) -> int:
        """More than at rest where it is stretched by s: the stiffness of St. Venant and Kirchhoff's law grows as
        (3 s^2 - 1) / 2."""
        stretch = max(1.0, self._meter.read().stretch_max)
        return max(1, math.ceil(dt / self.stable * math.sqrt((3 * stretch**2 - 1) / 2)))

    @property
    def bytes(self) -> int:
        return super().bytes + 8 * (24 * self._shell.triangles + 15 * self.mesh.count)
