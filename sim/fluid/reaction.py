"""What the fluid does to the bodies that it moves: sums over the pairs of particles and samples of their surfaces.

Every pair acts on both with equal and opposite forces along one line (Akinci et al. 2012, eq. 9), so that momentum and
angular momentum are kept. Pressures that are looked for move the bodies, too: with the forces J q of the pressures
q = p / rho^2 on a body of mass M, its samples give way, and compress the fluid by dt^2 J^T M^-1 J q less. Bodies are so
part of the system of equations of `sim.fluid.projection`, which stays symmetric and negative semidefinite: however
light they are, there is no step from which on the two throw each other back and forth (compare Gissler et al. 2019,
who iterate between two systems).
"""

from __future__ import annotations

import numpy as np
import taichi as ti

from sim.arrays import integer_array
from sim.fluid.momentum import Momentum
from sim.fluid.reaction_sums import answer_pressure, expect, give_way, push_back
from sim.fluid.system import FluidSystem
from sim.neighbors import NeighborList

CHUNK = 32
"""Samples of a body are summed over in groups of so many, and then over these: in a fixed order, on all threads."""
INERTIA = 13
"""Numbers that say how a body answers a force: centre of mass (3), inverse mass, inverse inertia in the world (9)."""


class Reaction:
    """Sums for the bodies that are the `rows` of those that move in the boundary of `system`.

    A wrench is the force [N] and the torque about the centre of mass [N m], shape [6]; an answer is the acceleration
    [m/s^2] and the angular acceleration [rad/s^2] by it.
    """

    def __init__(self, system: FluidSystem, rows: list[int]):
        self.system = system
        self.count = len(rows)
        self.near = NeighborList(48)
        moving = system.boundary.moving
        body_of = np.full(len(system.boundary.points), -1, dtype=np.int32)
        chunks, ends = [], [0]
        for body, row in enumerate(rows):
            mine = moving.first + np.flatnonzero(moving.body == row)
            body_of[mine] = body
            chunks += [(begin, min(begin + CHUNK, mine[-1] + 1), body) for begin in range(mine[0], mine[-1] + 1, CHUNK)]
            ends.append(len(chunks))
        self.body_of = integer_array(body_of)
        self.chunks, self.ends = integer_array(np.array(chunks)), integer_array(np.array(ends))
        self.partial = ti.ndarray(ti.f64, (len(chunks), 6))
        self._inertia = ti.ndarray(ti.f64, (self.count, INERTIA))
        self._wrench = ti.ndarray(ti.f64, (self.count, 6))
        self._answer = ti.ndarray(ti.f64, (self.count, 6))

    def list(self) -> None:
        """List the particles near each sample, as the particles' lists are made."""
        system = self.system
        moving = system.boundary.moving
        self.near.build(moving.here, moving.count, system.grid, system.particles.position, same=False)

    def weigh(self, inertia: np.ndarray) -> None:
        """Say how bodies answer forces, shape [bodies, INERTIA]; centres are relative to the world's origin."""
        self.inertia = inertia
        self._inertia.from_numpy(np.ascontiguousarray(inertia))

    def forces(self, momentum: Momentum) -> np.ndarray:
        """Wrenches of the forces that positions and velocities give, shape [bodies, 6]."""
        system = self.system
        particles, boundary, walls = system.particles, system.boundary, system.walls
        push_back(
            self.ends,
            self.chunks,
            system.h,
            system.mass,
            system.spec.rest_density,
            particles.position,
            particles.velocity,
            self.near.size,
            self.near.index,
            boundary.moving.first,
            boundary.samples,
            boundary.velocity,
            walls.count,
            walls.fit,
            walls.planes,
            self._inertia,
            momentum.pressure,
            momentum.grip.walls > 0,
            momentum.grip.samples,
            momentum.grip.nearest,
            momentum.damping > 0,
            momentum.damping,
            momentum.adhesion > 0,
            momentum.adhesion,
            self.partial,
            self._wrench,
        )
        return self._wrench.to_numpy()

    def answer(self, ahead: float) -> None:
        """Find how bodies answer the pressures in position.w, and leave in push.w by how much that lowers the second
        derivative of the densities of particles [kg/(m^3 s^2)]; pairs act where particles will be `ahead` [s]."""
        self._sum(ahead, self.system.particles.position, found=False)
        self._give_way(ahead)

    def answer_beside(self, dt: float, expected: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As `answer`, where bodies will be `dt` ahead, but for what they were expected to answer, shape [bodies, 6];
        returns the wrenches and answers."""
        self._sum(dt, self.system.particles.position, found=False)
        wrench, answer = self._wrench.to_numpy(), self._answer.to_numpy()
        self._answer.from_numpy(answer - expected)
        self._give_way(dt)
        return wrench, answer

    def pressed(self, ahead: float) -> tuple[np.ndarray, np.ndarray]:
        """Wrenches of the pressures found, which are in search.x, and the answers; shape [bodies, 6]."""
        self._sum(ahead, self.system.particles.search, found=True)
        return self._wrench.to_numpy(), self._answer.to_numpy()

    def expect(self, dt: float, answer: np.ndarray) -> None:
        """Bodies are where this answer, shape [bodies, 6], has taken them in the step: it is no compression then."""
        self._answer.from_numpy(answer)
        self._give_way(dt)
        expect(self.system.count, dt, self.system.particles.push, self.system.particles.source)

    def _sum(self, ahead: float, pressure: ti.Ndarray, *, found: bool) -> None:
        system = self.system
        particles, boundary, walls = system.particles, system.boundary, system.walls
        answer_pressure(
            self.ends,
            self.chunks,
            ahead,
            system.h,
            system.mass,
            system.spec.rest_density,
            particles.position,
            particles.velocity,
            pressure,
            found,
            self.near.size,
            self.near.index,
            boundary.moving.first,
            boundary.samples,
            walls.count,
            walls.fit,
            walls.planes,
            self._inertia,
            self.partial,
            self._wrench,
            self._answer,
        )

    def _give_way(self, ahead: float) -> None:
        system = self.system
        particles, boundary, walls = system.particles, system.boundary, system.walls
        give_way(
            system.count,
            ahead,
            system.h,
            system.spec.rest_density,
            particles.position,
            particles.velocity,
            boundary.samples,
            boundary.neighbors.size,
            boundary.neighbors.index,
            self.body_of,
            walls.count,
            walls.fit,
            walls.planes,
            self._inertia,
            self._answer,
            particles.push,
        )

    @property
    def bytes(self) -> int:
        return self.near.bytes + 4 * self.body_of.shape[0] + 48 * self.partial.shape[0]
