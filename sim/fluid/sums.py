"""Sums over ranges of particles, in a fixed order: they do not depend on threads."""

import taichi as ti

BLOCKS = 256
"""Into so many ranges particles are divided where one level of sums is enough."""


@ti.func
def span(part: ti.i32, parts: ti.i32, count: ti.i32) -> ti.types.vector(2, ti.i32):
    """Begin and end of one of so many ranges of equal size; no product of the counts, which would overflow."""
    size = (count + parts - 1) // parts
    return ti.Vector([ti.min(part * size, count), ti.min((part + 1) * size, count)])
