"""Kernels for `test_launching.py`: they cannot be in a file with postponed annotations."""

from sim.device.argument_packs import argpack
from sim.device.compiler import ti

Numbers = ti.types.ndarray(dtype=ti.f64, ndim=1)
Vectors = ti.types.ndarray(dtype=ti.types.vector(3, ti.f64), ndim=1)
Pack = argpack(one=Numbers, other=Vectors)
vec3 = ti.types.vector(3, ti.f64)


@ti.kernel
def add(double: ti.template(), count: ti.i32, factor: ti.f64, way: vec3, table: Numbers, pack: Pack) -> ti.f64:
    """Add factor to the numbers and way to the vectors; returns the sum of the numbers."""
    total = ti.cast(0.0, ti.f64)
    for i in range(count):
        step = factor
        if ti.static(double):
            step = 2.0 * factor
        table[i] += step
        pack.one[i] += step
        pack.other[i] += way
    for i in range(count):
        total += table[i]
    return total
