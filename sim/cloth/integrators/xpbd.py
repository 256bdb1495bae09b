"""Extended position-based dynamics in small steps (Macklin et al. 2016, 2019).

Springs and hinges are constraints with the compliance 1 / k: their multipliers begin at zero in each substep, or
stiffness would depend on the number of sweeps. Constraints without a common point have one colour and are solved side
by side.
"""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.arrays import hinge_arrays, numbers, spring_arrays
from sim.cloth.fabric.coloring import colored
from sim.cloth.fabric.layout import Hinges, Springs
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.integrators import xpbd_sums
from sim.cloth.integrators.small_steps import SmallSteps
from sim.cloth.integrators.xpbd_sums import Multipliers
from sim.cloth.spec import Cloth


class XPBD(SmallSteps):
    def __init__(self, mesh: ClothMesh, gravity: np.ndarray, settings: Cloth, collisions: Collisions):
        super().__init__(mesh, gravity, collisions)
        self.settings = settings.integrator_settings
        self._multipliers = Multipliers(
            spring_multiplier=numbers(np.zeros(mesh.springs)),
            hinge_multiplier=numbers(np.zeros(mesh.hinges)),
        )
        order, self._spring_colors = colored(mesh.ends, mesh.count)
        self._springs: Springs = spring_arrays(
            mesh.ends[order], mesh.rest[order], mesh.stiffness[order], mesh.damping[order], mesh.count
        )
        order, self._hinge_colors = colored(mesh.corners, mesh.count)
        self._hinges: Hinges = hinge_arrays(
            mesh.corners[order],
            mesh.rest_angle[order],
            mesh.rigidity[order],
            mesh.bend_damping[order],
            mesh.count,
        )
        self._model = mesh.as_model(self._springs, self._hinges)

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
            contacts.count,
            self.sweeps,
            dt,
            self.recovery(number),
            self._model,
            self._multipliers,
            contacts.projected,
            self.motion,
        )

    def _substep(self, dt: float, number: int, left: int) -> None:
        mesh, multipliers, motion = self.mesh, self._multipliers, self.motion
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
            multipliers,
            motion,
        )
        for _ in range(self.settings.iterations):
            for first, last in self._spring_colors:
                xpbd_sums.project_springs(first, last, dt, mesh.points, self._springs, multipliers, motion)
            for first, last in self._hinge_colors:
                xpbd_sums.project_hinges(first, last, dt, mesh.points, self._hinges, multipliers, motion)
        self.project_contacts(dt, number, left)
        xpbd_sums.finish(mesh.count, dt, mesh.points, motion)

    @property
    def bytes(self) -> int:
        return super().bytes + 8 * (6 * self.mesh.springs + 8 * self.mesh.hinges)
