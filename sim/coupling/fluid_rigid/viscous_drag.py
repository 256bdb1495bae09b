"""Bodies that obey forces in the equations of implicit viscosity (`sim.fluid.forces.implicit_viscosity`).

With U the velocity and angular velocity of a body of mass matrix M, J U those that its motion has where particles are,
and K the friction of pairs, its own equations are M (U - U*) + dt m J^T K (v - J U) = 0, the opposite of what it does
to the particles. Over the mass m of a particle they stand below those of the particles, and the whole stays symmetric
and positive definite: however light a body and however thick the fluid, there is no step from which on it is thrown.
"""

from __future__ import annotations

import numpy as np

from sim.coupling.fluid_rigid import viscous_drag_sums
from sim.coupling.fluid_rigid.reaction import Reaction
from sim.device.compiler import ti
from sim.fluid.forces.body_unknowns import CENTRE, CHANGE, COLUMNS, IMAGE, INERTIA, INVERSE, MASS, RESIDUAL, SEARCH
from sim.fluid.system import FluidSystem


class ViscousDrag:
    """Unknowns of the bodies of a system, and their part in conjugate gradients.

    `table`: a row for each body, as `sim.fluid.forces.body_unknowns` has it.
    """

    def __init__(self, system: FluidSystem, reaction: Reaction):
        self.system = system
        self.reaction = reaction
        self.body_of = self.reaction.body_of
        self.table = ti.ndarray(ti.f64, (self.reaction.count, COLUMNS))

    def begin(self, viscosity: float, sums: ti.Ndarray) -> None:
        """Residuals and directions, where particles have their first guess as velocity, and viscous_search.w is the
        density."""
        self._viscosity = viscosity
        table = self._weighed()
        self.table.from_numpy(table)
        self._sum(viscous_drag_sums.AS_THEY_MOVE, with_mass=False)
        viscous_drag_sums.begin(self.table, sums, sums.shape[0] - 1)

    def pull(self) -> None:
        """The images of the searches."""
        self._sum(viscous_drag_sums.SEARCHES, with_mass=True)

    def finish(self, *, solved: bool) -> np.ndarray:
        """By how much velocities and angular velocities change, shape [bodies, 6]; with what is left of the residual
        where that is small, so that momentum is kept."""
        table = self.table.to_numpy()
        change = table[:, CHANGE : CHANGE + 6]
        if solved:
            change = change + np.linalg.solve(self._masses(table), table[:, RESIDUAL : RESIDUAL + 6, None])[:, :, 0]
        return change

    def _weighed(self) -> np.ndarray:
        """The table with masses and preconditioner: the blocks of the system of equations."""
        inertia, mass = self.reaction.inertia, self.system.mass
        table = np.zeros((len(inertia), COLUMNS))
        table[:, CENTRE : CENTRE + 3] = inertia[:, :3]
        table[:, MASS] = 1.0 / (mass * inertia[:, 3])
        table[:, INERTIA:] = np.linalg.inv(inertia[:, 4:].reshape(-1, 3, 3)).reshape(-1, 9) / mass
        blocks = np.zeros((len(table), 6, 6))
        for column in range(6):
            table[:, SEARCH : SEARCH + 6] = np.eye(6)[column]
            self.table.from_numpy(table)
            self._sum(viscous_drag_sums.ALONE, with_mass=True)
            blocks[:, :, column] = self.table.to_numpy()[:, IMAGE : IMAGE + 6]
        table[:, INVERSE : INVERSE + 36] = np.linalg.inv(blocks).reshape(-1, 36)
        return table

    @staticmethod
    def _masses(table: np.ndarray) -> np.ndarray:
        masses = np.zeros((len(table), 6, 6))
        masses[:, :3, :3] = table[:, MASS, None, None] * np.eye(3)
        masses[:, 3:, 3:] = table[:, INERTIA:].reshape(-1, 3, 3)
        return masses

    def _sum(self, which: int, *, with_mass: bool) -> None:
        system, reaction = self.system, self.reaction
        particles = system.particles
        viscous_drag_sums.drag(
            which,
            with_mass,
            1.0 / system.h,
            system.spec.rest_density * self._viscosity,
            particles.position,
            particles.velocity,
            particles.viscous_search,
            system.boundary.faces.lists,
            reaction.sums,
            self.table,
        )
