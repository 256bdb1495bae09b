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

import taichi as ti

from sim.device.arrays import DoubleTable, RealArray, real, vec4
from sim.fluid.boundary.half_space import along_faces
from sim.fluid.forces.pairwise import Lens, matrix, pair_pressures
from sim.fluid.kernel import cubic_slope, slope_norm
from sim.fluid.layout import Q, Resolution, Walls
from sim.fluid.pressure.incompressible import WORST
from sim.fluid.pressure.projection import Unknowns
from sim.fluid.sums import mean_and_worst, span
from sim.fluid.system import FluidSystem
from sim.neighbors.spatial_hash import Neighbors, padded

FIRST = 0.8
"""Length of the Jacobi step in the first trial."""
TRIAL = 1.2
"""Length of further trial steps over a Jacobi step: the line search shortens what is too long."""
ROWS = 1024
"""Sums are taken over so many ranges of particles, then over those, so that they do not depend on threads."""
ROW = 16
"""Particles in a range on a GPU, which has that many threads; these are summed over GROUPS ranges of them first."""
GROUPS = 256
PUSH, DESCEND, CORRECTED = 1, 2, 4
"""Bits of what is compiled of an iteration: what comes before and after bodies respond to the pressures of the trial,
and whether gradients are corrected."""


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
        _begin(
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
        strongest = _finish(system.count, dt, warm, particles.bundle(Unknowns))
        return Solution(iteration, dt * dt * strongest, mean > tolerance or worst > self.worst)

    def _iterate(self, parts: int, dt: float, *, first: bool) -> tuple[float, float]:
        system, particles = self.system, self.system.particles
        mean, worst = _iterate(
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
        mean, worst = _compression(self.system.count, self._rows, self.system.particles.source, self._sums)
        return mean, worst

    @property
    def _rows(self) -> int:
        """Ranges of particles over which is summed first; there is room for their sums."""
        rows = -(-self.system.count // ROW) if self._grouped else ROWS
        if rows + GROUPS >= self._sums.shape[0]:
            self._sums = ti.ndarray(ti.f64, (rows + rows // 4 + GROUPS + 1, 4))
        return rows


@ti.func
def _add(sums: DoubleTable, columns: ti.template(), group: ti.i32, rows: ti.i32):
    """Sum the first columns of one of GROUPS ranges of rows, into a row behind those."""
    within = span(group, GROUPS, rows)
    for column in ti.static(range(columns)):
        total = ti.cast(0.0, ti.f64)
        for row in range(within[0], within[1]):
            total += sums[row, column]
        sums[rows + group, column] = total


@ti.func
def _summands(grouped: ti.template(), rows: ti.i32) -> ti.types.vector(2, ti.i32):
    """Begin and end of what is left to sum: the rows, or the groups behind them."""
    return ti.Vector([rows, rows + GROUPS]) if ti.static(grouped) else ti.Vector([0, rows])


@ti.func
def _share(sums: DoubleTable, grouped: ti.template(), rows: ti.i32) -> ti.f64:
    """Of a step, that minimises the energy: gain over bend."""
    gain, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    within = _summands(grouped, rows)
    for row in range(within[0], within[1]):
        gain += sums[row, 0]
        bend += sums[row, 1]
    return ti.select(bend > 0.0, ti.math.clamp(gain / bend, 0.0, 1.0), 0.0)


@ti.kernel
def _compression(count: ti.i32, rows: ti.i32, source: RealArray, sums: DoubleTable) -> ti.types.vector(2, ti.f64):
    for row in range(rows):
        error, worst = ti.cast(0.0, ti.f64), ti.cast(0.0, real)
        within = span(row, rows, count)
        for i in range(within[0], within[1]):
            error += ti.max(source[i], 0.0)
            worst = ti.max(worst, source[i])
        sums[row, 0] = error
        sums[row, 1] = worst
    return mean_and_worst(count, rows, sums)


@ti.kernel
def _begin(
    count: ti.i32,
    rows: ti.i32,
    grouped: ti.template(),
    dt: real,
    warm: ti.i32,
    p: Unknowns,
    sums: DoubleTable,
):
    """The first trial, from the share of the last pressures that minimises the energy, as far as is known yet."""
    dt2 = dt * dt
    last = sums.shape[0] - 1
    for row in range(rows):
        gain, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        within = span(row, rows, count)
        for i in range(within[0], within[1]):
            q, s = p.position[i][Q], p.source[i]
            if warm != 0 and q + s * p.diagonal[i] / dt2 > 0.0:
                gain += s * q
                bend -= q * dt2 * p.acceleration[i].w
        sums[row, 0] = gain
        sums[row, 1] = bend
    if ti.static(grouped):
        for group in range(GROUPS):
            _add(sums, 2, group, rows)
    ti.loop_config(serialize=True)
    for _ in range(1):
        sums[last, 0] = _share(sums, grouped, rows)
    for i in range(count):
        share, s = ti.cast(sums[last, 0], real), p.source[i]
        p.kept[i] = vec4(0.0, 0.0, 0.0, s)
        p.search[i] = vec4(0.0, 0.0, p.position[i][Q], 0.0)
        left = s + share * dt2 * p.acceleration[i].w
        p.position[i][Q] = ti.max(share * p.position[i][Q] + FIRST * left * p.diagonal[i] / dt2, 0.0)


@ti.kernel
def _iterate(
    parts: ti.template(),
    first: ti.i32,
    count: ti.i32,
    rows: ti.i32,
    grouped: ti.template(),
    dt: real,
    fluid: Resolution,
    p: Unknowns,
    lens: Lens,
    near: Neighbors,
    walls: Walls,
    sums: DoubleTable,
) -> ti.types.vector(2, ti.f64):
    """One iteration; returns the mean error [kg/m^3] of the pressures it arrives at, and the worst."""
    inverse_h = 1.0 / fluid.h
    dt2 = dt * dt
    strength = fluid.mass * slope_norm(inverse_h)
    # The last row has the conjugacy of directions and the share of the trial step.
    last = sums.shape[0] - 1
    total, peak = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    if ti.static(parts & PUSH):
        for i in range(count):
            if first == 0:
                q, left = p.search[i].x, p.kept[i].w
                downhill = ti.select(q > 0.0 or left > 0.0, left * p.diagonal[i] / dt2, 0.0)
                p.position[i][Q] = ti.max(q + TRIAL * (downhill + ti.cast(sums[last, 0], real) * p.search[i].y), 0.0)
        for i in range(count):
            a = strength * pair_pressures(i, p.position, parts & CORRECTED, lens, near, inverse_h)
            a -= p.position[i][Q] * p.solid[i].xyz
            if walls.size[i] > 0:
                a = along_faces(i, a, walls, inverse_h)
            p.pressure_acceleration[i].xyz = a
    if ti.static(parts & DESCEND):
        for row in range(rows):
            gain, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
            within = span(row, rows, count)
            for i in range(within[0], within[1]):
                x, a = p.position[i], p.pressure_acceleration[i].xyz
                change = ti.cast(0.0, real)
                mine = ti.Matrix.identity(real, 3)
                if ti.static(parts & CORRECTED):
                    mine = matrix(lens.correction[i], lens.skew[i])
                for k in range(padded(near.size[i])):
                    j = near.index[i, k]
                    d = x.xyz - p.position[j].xyz
                    slope = cubic_slope(d.norm() * inverse_h)
                    if ti.static(parts & CORRECTED):
                        change += slope * (mine @ d).dot(a - p.pressure_acceleration[j].xyz)
                    else:
                        change += slope * d.dot(a - p.pressure_acceleration[j].xyz)
                change = strength * change + a.dot(p.solid[i].xyz)
                if ti.static(not parts & PUSH):
                    change -= p.pressure_acceleration[i].w
                left = p.source[i] + dt2 * change
                p.pressure_acceleration[i].w = left
                step = x[Q] - p.search[i].x
                gain += step * p.kept[i].w
                bend += step * (p.kept[i].w - left)
            sums[row, 0] = gain
            sums[row, 1] = bend
        if ti.static(grouped):
            for group in range(GROUPS):
                _add(sums, 2, group, rows)
        ti.loop_config(serialize=True)
        for _ in range(1):
            share = _share(sums, grouped, rows)
            # The first pressures are taken whole where that lowers the energy at all.
            sums[last, 1] = ti.select(first != 0 and share > 0.5, 1.0, share)
        for row in range(rows):
            error, across, along = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
            worst = ti.cast(0.0, real)
            share = ti.cast(sums[last, 1], real)
            within = span(row, rows, count)
            for i in range(within[0], within[1]):
                step = share * (p.position[i][Q] - p.search[i].x)
                change = share * (p.pressure_acceleration[i] - p.kept[i])
                p.kept[i] += change
                p.search[i].x += step
                p.search[i].y = step
                q, left = p.search[i].x, p.kept[i].w
                downhill = ti.select(q > 0.0 or left > 0.0, left * p.diagonal[i] / dt2, 0.0)
                across += downhill * change.w
                along += step * change.w
                error += ti.max(left, 0.0)
                if walls.excess[i] == 0.0:
                    worst = ti.max(worst, left)
            sums[row, 0] = across
            sums[row, 1] = along
            sums[row, 2] = error
            sums[row, 3] = worst
        if ti.static(grouped):
            for group in range(GROUPS):
                _add(sums, 3, group, rows)
                worst = ti.cast(0.0, ti.f64)
                within = span(group, GROUPS, rows)
                for row in range(within[0], within[1]):
                    worst = ti.max(worst, sums[row, 3])
                sums[rows + group, 3] = worst
        ti.loop_config(serialize=True)
        for _ in range(1):
            across, along = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
            within = _summands(grouped, rows)
            for row in range(within[0], within[1]):
                across += sums[row, 0]
                along += sums[row, 1]
                total += sums[row, 2]
                peak = ti.max(peak, sums[row, 3])
            sums[last, 0] = ti.select(along < 0.0, ti.max(-across / along, 0.0), 0.0)
    return ti.Vector([total / count, peak])


@ti.kernel
def _finish(count: ti.i32, dt: real, warm: ti.i32, p: Unknowns) -> real:
    """Push, and leave what was found in position.w, and its L q in acceleration.w, or both as they were; L q in
    kept.w, too.

    Returns the strongest acceleration.
    """
    strongest = ti.cast(0.0, real)
    for i in range(count):
        p.velocity[i].xyz += dt * p.kept[i].xyz
        ti.atomic_max(strongest, p.kept[i].xyz.norm_sqr())
        changed = (p.kept[i].w - p.source[i]) / (dt * dt)
        p.kept[i].w = changed
        if warm != 0:
            p.position[i][Q] = p.search[i].x
            p.acceleration[i].w = changed
        else:
            p.position[i][Q] = p.search[i].z
    return ti.sqrt(strongest)
