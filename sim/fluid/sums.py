"""Sums over ranges of particles, in a fixed order: they do not depend on threads."""

from sim.device.arrays import DoubleTable
from sim.device.compiler import ti

BLOCKS = 256
"""Into so many ranges particles are divided where one level of sums is enough."""


@ti.func
def span(part: ti.i32, parts: ti.i32, count: ti.i32) -> ti.types.vector(2, ti.i32):
    """Begin and end of one of so many ranges of equal size; no product of the counts, which would overflow."""
    size = (count + parts - 1) // parts
    return ti.Vector([ti.min(part * size, count), ti.min((part + 1) * size, count)])


@ti.func
def mean_and_worst(count: ti.i32, blocks: ti.i32, sums: DoubleTable) -> ti.types.vector(2, ti.f64):
    """Of `count` particles, by the sum of each block in the first column and its maximum, if positive, in the
    second."""
    total, worst = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    ti.loop_config(serialize=True)
    for block in range(blocks):
        total += sums[block, 0]
        worst = ti.max(worst, sums[block, 1])
    return ti.Vector([total / count, worst])
