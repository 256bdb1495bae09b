"""What the fluid does to the bodies that it moves: sums over the pairs of particles and bodies near them.

Each body is a half-space to a particle (`sim.fluid.boundary`), and what it does to the particle is done to it at the
same place, so that momentum and angular momentum are kept. Pressures that are looked for move the bodies, too: with the
forces J q of the pressures q = p / rho^2 on a body of mass M, it gives way, and compresses the fluid by
dt^2 J^T M^-1 J q less. Bodies are so part of the system of equations of `sim.fluid.pressure.projection`, which stays
symmetric and negative semidefinite: however light they are, there is no step from which on the two throw each other
back and forth (compare Gissler et al. 2019, who iterate between two systems).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sim.coupling.fluid_rigid import reaction_sums
from sim.coupling.fluid_rigid.reaction_sums import PARTS, RANGES, BodySums
from sim.device.arrays import GROWTH, integer_array
from sim.device.compiler import ti
from sim.fluid.forces.pairwise import Lens
from sim.fluid.forces.terms import BY_SOLIDS, WALL_FRICTION, Terms

if TYPE_CHECKING:
    from sim.fluid.forces.terms import Terms
    from sim.fluid.system import FluidSystem

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""


class Lubrication(Protocol):
    """What acts on bodies where fluid has no particles, by the pressures of others."""

    active: bool

    def pressed(self, pressure: ti.Ndarray, wrench: ti.Ndarray, *, found: bool) -> None:
        """Write wrenches by the pressures as q in w, or where they are `found` in x, shape [bodies, 6]."""

    def add_response(self, response: ti.Ndarray) -> None:
        """Add to pressure_acceleration.w what these responses of bodies do to those particles."""


INERTIA = 13
"""Numbers of a body that decide its response: centre of mass (3), inverse mass, inverse inertia in the world (9)."""


class Reaction:
    """Sums for the bodies that are the `solids`, by their index, in the boundary of `system`.

    A wrench is the force [N] and the torque about the centre of mass [N m], shape [6]; a response is the acceleration
    [m/s^2] and the angular acceleration [rad/s^2] by it. body_of: of each solid which of these it is, or -1; sums: its
    entries in order, and what is summed over them.
    """

    def __init__(self, system: FluidSystem, solids: Sequence[int]):
        self.system = system
        self.count = len(solids)
        body_of = np.full(max(system.boundary.shapes.count, 1), -1, dtype=np.int32)
        body_of[list(solids)] = np.arange(self.count)
        self.body_of = integer_array(body_of)
        self._ends = ti.ndarray(ti.i32, self.count + 1)
        self._partial = ti.ndarray(ti.f64, (PARTS * self.count, 6))
        self._tally = ti.ndarray(ti.i32, RANGES * self.count)
        self._inertia = ti.ndarray(ti.f64, (self.count, INERTIA))
        self._wrench, self._response, self._by_lubrication = (ti.ndarray(ti.f64, (self.count, 6)) for _ in range(3))
        self.sums = self._sums_of(ti.ndarray(ti.i32, 1))
        self.lubrication: Lubrication | None = None

    def list(self) -> None:
        """Sort the entries of the bodies by these, in a fixed order, as they are listed now."""
        count, walls = self.system.count, self.system.boundary.faces.lists
        total = reaction_sums.tally(count, walls, self.sums, self._tally)
        if total > self.sums.order.shape[0]:
            self.sums = self._sums_of(ti.ndarray(ti.i32, int(GROWTH * total)))
        reaction_sums.sort(count, walls, self.sums, self._tally)

    def _sums_of(self, order: ti.Ndarray) -> BodySums:
        return BodySums(
            self.body_of,
            self._ends,
            order,
            self._inertia,
            self._partial,
            self._by_lubrication,
            self._wrench,
            self._response,
        )

    def lubrication_wrenches(self) -> np.ndarray:
        """Wrenches of films by the pressures in position.w."""
        self._sum_lubrication(self.system.particles.position, found=False)
        return self._by_lubrication.to_numpy()

    def _sum_lubrication(self, pressure: ti.Ndarray, *, found: bool) -> None:
        if self.lubrication and self.lubrication.active:
            self.lubrication.pressed(pressure, self._by_lubrication, found=found)
        else:
            self._by_lubrication.fill(0)

    def set_inertia(self, inertia: np.ndarray) -> None:
        """Set how bodies respond to forces, shape [bodies, INERTIA]; centres are relative to the world's origin."""
        self.inertia = inertia
        self._inertia.from_numpy(np.ascontiguousarray(inertia))

    def forces(self, terms: Terms, friction: float | None = None) -> np.ndarray:
        """Wrenches of the forces that positions and velocities give, shape [bodies, 6]; friction: viscosity of what the
        fluid sticks to [m^2/s], where that is not what acts as a force."""
        system, bits, viscosity = self.system, terms.bits, terms.viscosity
        if friction is not None:
            bits, viscosity = (bits | WALL_FRICTION) if friction > 0 else (bits & ~WALL_FRICTION), friction
        reaction_sums.push_back(
            bits & BY_SOLIDS,
            viscosity,
            terms.adhesion_solids,
            terms.coefficients,
            system.resolution,
            system.particles.position,
            system.particles.velocity,
            system.boundary.faces.lists,
            self.sums,
        )
        return self._wrench.to_numpy()

    def held(self) -> np.ndarray:
        """Wrenches of what these hold along their surfaces (`along_faces`), by the pressures in position.w, shape
        [bodies, 6]."""
        system = self.system
        particles = system.particles
        corrected = hasattr(particles, "correction")
        reaction_sums.hold(
            corrected,
            system.resolution,
            particles.position,
            particles.bundle(Lens) if corrected else particles.bundle(Lens, correction="position", skew="position"),
            system.neighbors.lists,
            system.boundary.faces.lists,
            self.sums,
        )
        return self._wrench.to_numpy()

    def respond(self, ahead: float) -> None:
        """Find how bodies respond to the pressures in position.w, and leave in pressure_acceleration.w by how much that
        lowers the second derivative of the densities of particles [kg/(m^3 s^2)]; pairs act where particles will be
        `ahead` [s]."""
        self._sum(ahead, self.system.particles.position, found=False)
        self._add_response(ahead)

    def respond_beside_expected(self, dt: float, expected: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As `respond`, where bodies will be `dt` ahead, less the response that was expected, shape [bodies, 6];
        returns the wrenches and responses."""
        self._sum(dt, self.system.particles.position, found=False)
        wrench, response = self._wrench.to_numpy(), self._response.to_numpy()
        self._response.from_numpy(response - expected)
        self._add_response(dt)
        return wrench, response

    def pressed(self, ahead: float) -> tuple[np.ndarray, np.ndarray]:
        """Wrenches of the pressures found, which are in search.x, and the responses; shape [bodies, 6]."""
        self._sum(ahead, self.system.particles.search, found=True)
        return self._wrench.to_numpy(), self._response.to_numpy()

    def subtract_predicted(self, dt: float, response: np.ndarray) -> None:
        """Bodies are where this response, shape [bodies, 6], has taken them in the step: it is no compression then."""
        self._response.from_numpy(response)
        self._add_response(dt)
        reaction_sums.subtract_predicted(
            self.system.count, dt, self.system.particles.pressure_acceleration, self.system.particles.source
        )

    def _sum(self, ahead: float, pressure: ti.Ndarray, *, found: bool) -> None:
        system = self.system
        self._sum_lubrication(pressure, found=found)
        reaction_sums.respond(
            ahead,
            system.mass * system.spec.rest_density,
            system.particles.position,
            system.particles.velocity,
            pressure,
            found,
            system.boundary.faces.lists,
            self.sums,
        )

    def _add_response(self, ahead: float) -> None:
        system = self.system
        reaction_sums.add_response(
            system.count,
            ahead,
            system.spec.rest_density,
            system.particles.position,
            system.particles.velocity,
            system.boundary.faces.lists,
            self.sums,
            system.particles.pressure_acceleration,
        )
        if self.lubrication and self.lubrication.active:
            self.lubrication.add_response(self._response)

    @property
    def bytes(self) -> int:
        """Memory of the order of entries, and of partial sums [bytes]."""
        return 4 * (self.sums.order.shape[0] + self._tally.shape[0]) + 48 * self._partial.shape[0]
