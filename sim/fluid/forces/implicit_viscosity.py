"""Implicit viscosity (Weiler et al. 2018): for fluids so thick that explicit steps would be tiny.

The velocities after the step dt are those that the friction of the step itself slows:
    v - dt K v = v*,    K v the sum over pairs of `sim.fluid.forces.pairwise.viscous` and the friction of
    `sim.fluid.forces.friction`
(backward Euler). K is symmetric and negative semidefinite. Conjugate gradients solve the system, with the
inverses of its diagonal's 3 x 3 blocks as preconditioner, from the velocities to which the
friction of the step before leads. What is left of the residual r at the end is added: v* + dt K v = v + r,
which is made of pair forces alone, so that momentum and angular momentum are kept whatever the tolerance.
"""

import math

import numpy as np

from sim.device.arrays import Declared, numpy_real
from sim.device.compiler import ti
from sim.fluid.forces import implicit_viscosity_sums as sums
from sim.fluid.forces.body_unknowns import COLUMNS
from sim.fluid.forces.friction import find_wall_friction
from sim.fluid.forces.implicit_viscosity_sums import DESCEND, PUSH, WHOLE, Unknowns
from sim.fluid.protocols import ViscousDrag
from sim.fluid.sums import BLOCKS
from sim.fluid.system import FluidSystem

ROUNDING = 4 * float(np.finfo(numpy_real).eps)
"""Residuals below this share of the velocities are rounding."""
CHECK = 4
"""The residual is read back after every so many iterations."""

ARRAYS = (
    Declared("viscous_acceleration", "vec4", "acceleration by viscosity in the last step [m/s^2]", saved=False),
    Declared("viscous_search", "vec4", "direction of the search [m/s]; w: density [kg/m^3]", sorted=False, saved=False),
    Declared("residual", "vec4", "v* - (1 - dt K) v [m/s]", sorted=False, saved=False),
    Declared("image", "vec4", "(1 - dt K) times the direction of the search [m/s]", sorted=False, saved=False),
    Declared("inverse", "vec4", "diagonal of the inverse of a block of 1 - dt K; w: its xy", sorted=False, saved=False),
    Declared("inverse_off", "vec4", "its xz and yz", sorted=False, saved=False),
)


class Viscosity:
    """Slows the particles of a system, whose arrays are those declared in ARRAYS; `viscous_acceleration` is sorted with
    them, and forgotten where a run may go on from a checkpoint."""

    def __init__(self, system: FluidSystem):
        self.system = system
        self.settings = system.spec.implicit_viscosity
        self.wall_friction = find_wall_friction(system.spec)
        self._sums = ti.ndarray(ti.f64, (BLOCKS + 1, 5))
        self._nowhere, self._nobody = ti.ndarray(ti.i32, 1), ti.ndarray(ti.f64, (1, COLUMNS))
        self._dragged: ViscousDrag | None = None

    def _drag(self) -> ViscousDrag | None:
        """The part of bodies that obey forces, if there are any that the fluid sticks to."""
        if self._dragged is None and self.system.bodies and self.wall_friction.walls > 0:
            self._dragged = self.system.bodies.viscous_drag()
        return self._dragged

    def apply(self, dt: float) -> dict[str, float]:
        """Replace the velocities by those after `dt` of friction; returns the statistics."""
        system = self.system
        viscosity = dt * system.spec.viscosity
        drag = self._drag()
        self._begin(dt, viscosity)
        if drag:
            drag.begin(viscosity, self._sums)
        iterations, solved = 0, self._is_solved()
        while not solved and iterations < self.settings.max_iterations:
            for _ in range(min(CHECK, self.settings.max_iterations - iterations)):
                if drag:
                    self._iterate(PUSH, viscosity)
                    drag.pull()
                    self._iterate(DESCEND, viscosity)
                else:
                    self._iterate(WHOLE, viscosity)
                iterations += 1
            solved = self._is_solved()
        sums.finish(system.count, 1.0 / dt, solved, system.particles.bundle(Unknowns))
        if drag and system.bodies:
            system.bodies.apply_viscosity(dt, drag.finish(solved=solved))
        return {"viscosity_iterations": iterations, "capped": not solved}

    def _is_solved(self) -> bool:
        """Whether the residual is small next to what viscosity changes, or no more than rounding."""
        left, change, whole = (math.sqrt(max(value, 0.0)) for value in sums.norms(self._sums))
        return left <= max(self.settings.error * change, ROUNDING * whole)

    def _begin(self, dt: float, viscosity: float) -> None:
        system = self.system
        sums.begin(
            system.count,
            0.0 if system.forgetful else dt,
            viscosity,
            self.wall_friction.walls > 0,
            system.resolution,
            system.particles.bundle(Unknowns),
            system.neighbors.lists,
            system.boundary.faces.lists,
            self._sums,
        )
        system.forgetful = False

    def _iterate(self, part: int, viscosity: float) -> None:
        system, drag = self.system, self._dragged
        sums.iterate(
            part,
            system.count,
            viscosity,
            self.wall_friction.walls > 0,
            system.resolution,
            system.particles.bundle(Unknowns),
            system.neighbors.lists,
            system.boundary.faces.lists,
            drag.body_of if drag else self._nowhere,
            self._sums,
            drag.table if drag else self._nobody,
        )
