"""Extended position-based dynamics in small steps (Macklin et al. 2016, 2019).

Springs and hinges are constraints with the compliance 1 / k: their multipliers begin at zero in each substep, or
stiffness would depend on the number of sweeps. Constraints without a common point have one colour and are solved side
by side.
"""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.arrays import angle_arrays, numbers, strand_arrays
from sim.cloth.fabric.coloring import colored
from sim.cloth.fabric.layout import Angles, Strands
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.integrators import xpbd_sums
from sim.cloth.integrators.small_steps import SmallSteps
from sim.cloth.integrators.xpbd_sums import Guess
from sim.cloth.spec import Cloth


class XPBD(SmallSteps):
    def __init__(self, mesh: ClothMesh, gravity: np.ndarray, settings: Cloth, collisions: Collisions):
        super().__init__(mesh, gravity, collisions)
        self.settings = settings.integrator_settings
        self._guess = Guess(
            pulled=numbers(np.zeros(mesh.springs)),
            bent=numbers(np.zeros(mesh.hinges)),
        )
        order, self._spring_colors = colored(mesh.ends, mesh.count)
        self._strands: Strands = strand_arrays(
            mesh.ends[order], mesh.rest[order], mesh.stiffness[order], mesh.damping[order], mesh.count
        )
        order, self._hinge_colors = colored(mesh.corners, mesh.count)
        self._angles: Angles = angle_arrays(
            mesh.corners[order],
            mesh.rest_angle[order],
            mesh.rigidity[order],
            mesh.bend_damping[order],
            mesh.count,
        )

    def limits(self) -> dict[str, float]:
        """Largest steps [s] by what limits them: none."""
        return {}

    def substeps(self, dt: float) -> int:
        return self.settings.substeps

    def run(self, dt: float, number: int) -> None:
        mesh, contacts = self.mesh, self.collisions
        if not self.alone:
            for left in range(number, 0, -1):
                self._substep(dt, number, left)
            return
        xpbd_sums.substeps_alone(
            mesh.air.present,
            number,
            self.settings.iterations,
            mesh.count,
            mesh.springs,
            mesh.hinges,
            contacts.count,
            self.sweeps,
            dt,
            self.prompt(number),
            self.gravity,
            mesh.air.wind,
            mesh.points,
            self._strands,
            self._angles,
            mesh.air.drag,
            self._guess,
            contacts.touches,
            self.displacement,
        )

    def _substep(self, dt: float, number: int, left: int) -> None:
        mesh, guess, displacement = self.mesh, self._guess, self.displacement
        xpbd_sums.predict(
            mesh.air.present,
            mesh.count,
            mesh.springs,
            mesh.hinges,
            dt,
            left,
            self.gravity,
            mesh.air.wind,
            mesh.points,
            mesh.air.drag,
            guess,
            displacement,
        )
        for _ in range(self.settings.iterations):
            for first, last in self._spring_colors:
                xpbd_sums.project_springs(first, last, dt, mesh.points, self._strands, guess, displacement)
            for first, last in self._hinge_colors:
                xpbd_sums.project_hinges(first, last, dt, mesh.points, self._angles, guess, displacement)
        self.keep_apart(dt, number, left)
        xpbd_sums.finish(mesh.count, dt, mesh.points, displacement)

    @property
    def bytes(self) -> int:
        return super().bytes + 8 * (6 * self.mesh.springs + 8 * self.mesh.hinges)
