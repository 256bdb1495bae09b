"""Projected conjugate gradients for the pressures of `sim.fluid.pressure.projection`.

Every trial is projected to q >= 0, evaluated, and taken by the share of it that minimises the energy, so that the
energy falls in each iteration: too large a pressure left over from an impact is scaled down at once, where Jacobi
iterations would let it blow the fluid apart. The preconditioner is D.

The first trial takes the share of the last pressures that minimises the energy, and one Jacobi step from there. What
they do is known from the step before, L q, which is kept in acceleration.w: water at rest so needs no more iterations
than the change of its pressures.

Sources: Polyak 1969 (conjugate gradients with bounds), Ihmsen et al. 2014 (warm start, there with half the pressures).
"""

from dataclasses import dataclass

from sim.device.arrays import vec4
from sim.device.compiler import ti
from sim.fluid.forces.pairwise import Lens
from sim.fluid.pressure import conjugate_gradient_sums as sums
from sim.fluid.pressure.conjugate_gradient_sums import CORRECTED, DESCEND, GROUPS, PUSH, ROW, ROWS
from sim.fluid.pressure.incompressible import WORST
from sim.fluid.pressure.projection import Unknowns
from sim.fluid.system import FluidSystem


@dataclass(frozen=True)
class Solution:
    """Iterations that were made, and the longest way [m] that the pressures push a particle in the step; `capped` if
    more compression is left than was asked."""

    iterations: int
    displacement: float
    capped: bool


class ConjugateGradients:
    """Finds the pressures of a system whose source, diagonal and solids are given: by `sim.fluid.pressure.projection`,
    or with `corrected` gradients by `sim.fluid.pressure.gradient_correction`. worst: no particle may be left compressed
    by more [kg/m^3], whatever the mean, but for those that have no room in a gap: what a heavy body lands on would have
    to be driven out at any speed."""

    def __init__(self, system: FluidSystem, *, corrected: bool = False):
        self.system = system
        self.corrected = corrected
        self.worst = WORST * system.spec.rest_density
        self._grouped = ti.cfg.arch != ti.cpu
        self._sums = ti.ndarray(ti.f64, (ROWS + GROUPS + 1, 4))
        nothing = ti.ndarray(vec4, 1)
        self._no_lens = Lens(nothing, nothing)

    def solve(
        self, dt: float, tolerance: float, fewest: int, most: int, *, warm: bool, ahead: float, alone: bool = False
    ) -> Solution:
        """Find pressures that leave no more than `tolerance` [kg/m^3] of mean compression, and push by them: their
        accelerations are in kept.

        fewest, most: iterations, at least one. warm: begin with the pressures in position.w and leave the new ones
        there; else position.w stays as it is. ahead: solids press on particles where these will be then [s]. alone:
        bodies do not give way.
        """
        system, particles = self.system, self.system.particles
        bodies = None if alone else system.bodies
        sums.begin(
            system.count,
            self._rows,
            self._grouped,
            dt,
            warm,
            particles.bundle(Unknowns),
            self._sums,
        )
        for iteration in range(1, most + 1):
            if bodies:
                self._iterate(PUSH, dt, first=iteration == 1)
                bodies.respond(ahead)
                mean, worst = self._iterate(DESCEND, dt, first=iteration == 1)
            else:
                mean, worst = self._iterate(PUSH | DESCEND, dt, first=iteration == 1)
            if iteration >= fewest and mean <= tolerance and worst <= self.worst:
                break
        if bodies:
            bodies.gather_pressures(ahead)
        strongest = sums.finish(system.count, dt, warm, particles.bundle(Unknowns))
        return Solution(iteration, dt * dt * strongest, mean > tolerance or worst > self.worst)

    def _iterate(self, parts: int, dt: float, *, first: bool) -> tuple[float, float]:
        system, particles = self.system, self.system.particles
        mean, worst = sums.iterate(
            parts | (CORRECTED if self.corrected else 0),
            first,
            system.count,
            self._rows,
            self._grouped,
            dt,
            system.resolution,
            particles.bundle(Unknowns),
            particles.bundle(Lens) if self.corrected else self._no_lens,
            system.neighbors.lists,
            system.boundary.faces.lists,
            self._sums,
        )
        return mean, worst

    def compression(self) -> tuple[float, float]:
        """Mean and maximum of what is compressed without further pressure [kg/m^3]."""
        mean, worst = sums.compression(self.system.count, self._rows, self.system.particles.source, self._sums)
        return mean, worst

    @property
    def _rows(self) -> int:
        """Ranges of particles over which is summed first; there is room for their sums."""
        rows = -(-self.system.count // ROW) if self._grouped else ROWS
        if rows + GROUPS >= self._sums.shape[0]:
            self._sums = ti.ndarray(ti.f64, (rows + rows // 4 + GROUPS + 1, 4))
        return rows
