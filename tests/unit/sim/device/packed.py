"""A kernel for `test_argument_packs.py`: it cannot be in a file with postponed annotations."""

from sim.device.argument_packs import argpack
from sim.device.compiler import ti

Numbers = ti.types.ndarray(dtype=ti.f64, ndim=1)
Whole = ti.types.ndarray(dtype=ti.i32, ndim=1)
One = argpack(factor=ti.f64, size=Whole, value=Numbers)
Other = argpack(value=Numbers, factor=ti.f64, size=Whole)


Both = argpack(one=One, out=Numbers)


@ti.kernel
def copy(both: Both, factor: ti.f64):
    """Write factor value of the pack inside."""
    for i in range(both.out.shape[0]):
        both.out[i] = factor * both.one.value[i]


@ti.kernel
def combine(one: One, same: One, other: Other, out: Numbers):
    """Write factor value size of all three, in digits of their own."""
    for i in range(out.shape[0]):
        value = one.factor * one.value[i] * one.size[i]
        value += 10.0 * same.factor * same.value[i] * same.size[i]
        out[i] = value + 100.0 * other.factor * other.value[i] * other.size[i]
