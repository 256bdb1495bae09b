"""Bodies that obey forces in the equations of implicit viscosity (`sim.fluid.viscosity`).

With U the velocity and angular velocity of a body of mass matrix M, J U those of its samples, and K the friction of
pairs, its own equations are M (U - U*) + dt m J^T K (v - J U) = 0, the opposite of what the samples do to the
particles. Over the mass m of a particle they stand below those of the particles, and the whole stays symmetric and
positive definite: however light a body and however thick the fluid, there is no step from which on it is thrown.
"""

from __future__ import annotations

import numpy as np
import taichi as ti

from sim.arrays import vec4
from sim.fluid import drag_sums
from sim.fluid.drag_sums import CENTRE, CHANGE, COLUMNS, IMAGE, INERTIA, INVERSE, MASS, RESIDUAL, SEARCH
from sim.fluid.friction import Grip
from sim.fluid.system import FluidSystem


class Drag:
    """Unknowns of the bodies of a system, and their part in conjugate gradients.

    `table`: a row for each body, as `sim.fluid.drag_sums` has it; `search`: the direction in which samples would move.
    """

    def __init__(self, system: FluidSystem, grip: Grip):
        self.system, self.grip = system, grip
        self.reaction = system.bodies.reaction
        self.table = ti.ndarray(ti.f64, (self.reaction.count, COLUMNS))
        self.search = ti.ndarray(vec4, system.boundary.count)
        self.search.fill(0)

    def begin(self, viscosity: float, sums: ti.Ndarray) -> None:
        """Residuals and directions, where particles have their first guess as velocity, and search.w is the density."""
        self._viscosity = viscosity
        table = self._weighed()
        self.table.from_numpy(table)
        particles = self.system.particles
        self._sum(particles.velocity, self.system.boundary.velocity, with_mass=False)
        drag_sums.begin(self.table, sums, sums.shape[0] - 1)

    def push(self) -> None:
        """Where samples go along the search."""
        drag_sums.spread(self.reaction.body_of, self.system.boundary.samples, self.table, self.search)

    def pull(self) -> None:
        """The images of the searches."""
        self._sum(self.system.particles.search, self.search, with_mass=True)

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
            self.push()
            self._sum(self.system.particles.search, self.search, with_mass=True, alone=True)
            blocks[:, :, column] = self.table.to_numpy()[:, IMAGE : IMAGE + 6]
        table[:, INVERSE : INVERSE + 36] = np.linalg.inv(blocks).reshape(-1, 36)
        return table

    @staticmethod
    def _masses(table: np.ndarray) -> np.ndarray:
        masses = np.zeros((len(table), 6, 6))
        masses[:, :3, :3] = table[:, MASS, None, None] * np.eye(3)
        masses[:, 3:, 3:] = table[:, INERTIA:].reshape(-1, 3, 3)
        return masses

    def _sum(self, field: ti.Ndarray, sample_field: ti.Ndarray, *, with_mass: bool, alone: bool = False) -> None:
        system, reaction = self.system, self.reaction
        drag_sums.drag(
            reaction.ends,
            reaction.chunks,
            system.h,
            system.spec.rest_density,
            self._viscosity * self.grip.samples / system.spec.viscosity,
            self.grip.nearest,
            system.particles.position,
            system.particles.search,
            field,
            alone,
            reaction.near.size,
            reaction.near.index,
            system.boundary.moving.first,
            system.boundary.samples,
            sample_field,
            with_mass,
            self.table,
            reaction.partial,
        )
