"""What `sim.fluid.pressure.conjugate_gradients` does on the device."""

from sim.device.arrays import DoubleTable, RealArray, real, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.half_space import along_faces
from sim.fluid.forces.pairwise import Lens, matrix, pair_pressures
from sim.fluid.kernel import cubic_slope, slope_norm
from sim.fluid.layout import Q, Resolution, Walls
from sim.fluid.pressure.projection import Unknowns
from sim.fluid.sums import mean_and_worst, span
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
    within = ti.Vector([0, rows])
    if ti.static(grouped):
        within = ti.Vector([rows, rows + GROUPS])
    return within


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
def compression(count: ti.i32, rows: ti.i32, source: RealArray, sums: DoubleTable) -> ti.types.vector(2, ti.f64):
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
def begin(
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
def iterate(
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
                    j = near.index[near.begin[i] + k]
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
def finish(count: ti.i32, dt: real, warm: ti.i32, p: Unknowns) -> real:
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
