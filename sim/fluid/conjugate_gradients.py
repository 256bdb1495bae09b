"""Projected conjugate gradients for the pressures of `sim.fluid.projection`.

Every trial is projected to q >= 0, evaluated, and taken by the share of it that minimises the energy, so that the
energy falls in each iteration: too large a pressure left over from an impact is scaled down at once, where Jacobi
iterations would let it blow the fluid apart. The preconditioner is D. The first trial is made of the pressures of the
step before and of what a Jacobi step adds to none.

Sources: Polyak 1969 (conjugate gradients with bounds), Ihmsen et al. 2014 (warm start with half the pressures).
"""

from dataclasses import dataclass

import taichi as ti

from sim.arrays import DoubleTable, IntArray, IntTable, RealArray, Vec4Array, real, vec3, vec4
from sim.fluid.incompressible import WORST
from sim.fluid.kernel import cubic_slope
from sim.fluid.system import FluidSystem
from sim.neighbors import padded

WARM = 0.6
"""Share of the last step's pressures to begin with: all of them would keep the noise of the last step, too."""
FIRST = 0.8
"""What is added to them, over the pressures of a Jacobi step without any."""
TRIAL = 1.2
"""Length of a trial step over a Jacobi step: the line search shortens what is too long."""
ROW = 16
"""Sums are taken over so many particles, then over GROUPS ranges of those, so that they do not depend on threads."""
GROUPS = 256


@dataclass(frozen=True)
class Solution:
    """Iterations that were made, and the mean compression [kg/m^3] that is left; `capped` if more than was asked."""

    iterations: int
    error: float
    capped: bool


class ConjugateGradients:
    """Finds the pressures of a system whose `Projection` has given source, diagonal and solids."""

    def __init__(self, system: FluidSystem):
        self.system = system
        self.worst = WORST * system.spec.rest_density
        self._sums = ti.ndarray(ti.f64, (GROUPS + 1, 4))

    def solve(self, dt: float, tolerance: float, fewest: int, most: int) -> Solution:
        """Pressures in position.w, from those that are there, and their accelerations in kept.

        tolerance: mean compression [kg/m^3] that may be left. fewest: iterations; with 0 none are made, and pressures
        are zero, where without pressure no more is left. The accelerations are those of the pressures whose error is
        returned.
        """
        system, particles = self.system, self.system.particles
        if fewest == 0:
            mean, worst = _compression(system.count, self._rows, particles.source, self._sums)
            if mean <= tolerance and worst <= self.worst:
                _release(system.count, particles.position)
                return Solution(0, mean, False)
        for iteration in range(1, most + 1):
            mean, worst = _iterate(
                system.count,
                self._rows,
                dt,
                system.h,
                system.mass,
                iteration == 1,
                particles.position,
                particles.push,
                particles.kept,
                particles.search,
                particles.solid,
                particles.diagonal,
                particles.source,
                system.neighbors.size,
                system.neighbors.index,
                self._sums,
            )
            if iteration >= fewest and mean <= tolerance and worst <= self.worst:
                break
        _finish(system.count, particles.position, particles.search)
        return Solution(iteration, mean, mean > tolerance or worst > self.worst)

    @property
    def _rows(self) -> int:
        """Ranges of particles over which is summed first; there is room for their sums."""
        rows = -(-self.system.count // ROW)
        if rows + GROUPS >= self._sums.shape[0]:
            self._sums = ti.ndarray(ti.f64, (rows + rows // 4 + GROUPS + 1, 4))
        return rows


@ti.func
def _range(part: ti.i32, parts: ti.i32, count: ti.i32) -> ti.types.vector(2, ti.i32):
    """Begin and end of one of so many ranges of equal size."""
    size = (count + parts - 1) // parts
    return ti.Vector([ti.min(part * size, count), ti.min((part + 1) * size, count)])


@ti.kernel
def _compression(count: ti.i32, rows: ti.i32, source: RealArray, sums: DoubleTable) -> ti.types.vector(2, ti.f64):
    for row in range(rows):
        error, worst = ti.cast(0.0, ti.f64), ti.cast(0.0, real)
        span = _range(row, rows, count)
        for i in range(span[0], span[1]):
            error += ti.max(source[i], 0.0)
            worst = ti.max(worst, source[i])
        sums[row, 0] = error
        sums[row, 1] = worst
    total, peak = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    ti.loop_config(serialize=True)
    for row in range(rows):
        total += sums[row, 0]
        peak = ti.max(peak, sums[row, 1])
    return ti.Vector([total / count, peak])


@ti.kernel
def _iterate(
    count: ti.i32,
    rows: ti.i32,
    dt: real,
    h: real,
    mass: real,
    first: ti.i32,
    position: Vec4Array,
    push: Vec4Array,
    kept: Vec4Array,
    search: Vec4Array,
    solid: Vec4Array,
    diagonal: RealArray,
    source: RealArray,
    size: IntArray,
    index: IntTable,
    sums: DoubleTable,
) -> ti.types.vector(2, ti.f64):
    """One iteration; returns the mean error [kg/m^3] of the pressures it arrives at, and the worst."""
    inverse_h = 1.0 / h
    dt2 = dt * dt
    strength = mass * 8.0 / ti.math.pi * inverse_h**5
    # The last row has the conjugacy of directions and the share of the trial step.
    last = sums.shape[0] - 1
    for i in range(count):
        if first != 0:
            kept[i] = vec4(0.0, 0.0, 0.0, source[i])
            search[i] = vec4(0.0)
            position[i].w = ti.max(WARM * position[i].w + FIRST * source[i] * diagonal[i] / dt2, 0.0)
        else:
            q, left = search[i].x, kept[i].w
            downhill = ti.select(q > 0.0 or left > 0.0, left * diagonal[i] / dt2, 0.0)
            position[i].w = ti.max(q + TRIAL * (downhill + ti.cast(sums[last, 0], real) * search[i].y), 0.0)
    for i in range(count):
        x = position[i]
        a = vec3(0.0)
        for k in range(padded(size[i])):
            xj = position[index[i, k]]
            d = x.xyz - xj.xyz
            a -= (x.w + xj.w) * cubic_slope(d.norm() * inverse_h) * d
        push[i].xyz = strength * a - x.w * solid[i].xyz
    for row in range(rows):
        gain, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        span = _range(row, rows, count)
        for i in range(span[0], span[1]):
            x, a = position[i], push[i].xyz
            change = ti.cast(0.0, real)
            for k in range(padded(size[i])):
                j = index[i, k]
                d = x.xyz - position[j].xyz
                change += cubic_slope(d.norm() * inverse_h) * d.dot(a - push[j].xyz)
            left = source[i] + dt2 * (strength * change + a.dot(solid[i].xyz))
            push[i].w = left
            step = x.w - search[i].x
            gain += step * kept[i].w
            bend += step * (kept[i].w - left)
        sums[row, 0] = gain
        sums[row, 1] = bend
    for group in range(GROUPS):
        gain, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        span = _range(group, GROUPS, rows)
        for row in range(span[0], span[1]):
            gain += sums[row, 0]
            bend += sums[row, 1]
        sums[rows + group, 0] = gain
        sums[rows + group, 1] = bend
    ti.loop_config(serialize=True)
    for _ in range(1):
        gain, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        for group in range(GROUPS):
            gain += sums[rows + group, 0]
            bend += sums[rows + group, 1]
        share = ti.select(bend > 0.0, ti.math.clamp(gain / bend, 0.0, 1.0), 0.0)
        # The first pressures are taken whole where that lowers the energy at all.
        sums[last, 1] = ti.select(first != 0 and share > 0.5, 1.0, share)
    for row in range(rows):
        error, across, along = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        worst = ti.cast(0.0, real)
        share = ti.cast(sums[last, 1], real)
        span = _range(row, rows, count)
        for i in range(span[0], span[1]):
            step = share * (position[i].w - search[i].x)
            change = share * (push[i] - kept[i])
            kept[i] += change
            search[i].x += step
            search[i].y = step
            q, left = search[i].x, kept[i].w
            downhill = ti.select(q > 0.0 or left > 0.0, left * diagonal[i] / dt2, 0.0)
            across += downhill * change.w
            along += step * change.w
            error += ti.max(left, 0.0)
            worst = ti.max(worst, left)
        sums[row, 0] = across
        sums[row, 1] = along
        sums[row, 2] = error
        sums[row, 3] = worst
    for group in range(GROUPS):
        error, across, along = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        worst = ti.cast(0.0, ti.f64)
        span = _range(group, GROUPS, rows)
        for row in range(span[0], span[1]):
            across += sums[row, 0]
            along += sums[row, 1]
            error += sums[row, 2]
            worst = ti.max(worst, sums[row, 3])
        sums[rows + group, 0] = across
        sums[rows + group, 1] = along
        sums[rows + group, 2] = error
        sums[rows + group, 3] = worst
    total, peak = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    ti.loop_config(serialize=True)
    for _ in range(1):
        across, along = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        for group in range(GROUPS):
            across += sums[rows + group, 0]
            along += sums[rows + group, 1]
            total += sums[rows + group, 2]
            peak = ti.max(peak, sums[rows + group, 3])
        sums[last, 0] = ti.select(along < 0.0, ti.max(-across / along, 0.0), 0.0)
    return ti.Vector([total / count, peak])


@ti.kernel
def _finish(count: ti.i32, position: Vec4Array, search: Vec4Array):
    for i in range(count):
        position[i].w = search[i].x


@ti.kernel
def _release(count: ti.i32, position: Vec4Array):
    for i in range(count):
        position[i].w = 0.0
