"""A kernel for `test_summation.py`, as those of cloth: it cannot be in a file with postponed annotations."""

from sim.device.compiler import ti

Reals = ti.types.ndarray(dtype=ti.f64, ndim=1)
Wholes = ti.types.ndarray(dtype=ti.i32, ndim=1)


def sum_rows(first: Wholes, column: Wholes, value: Reals, total: Reals):
    for row in range(total.shape[0]):
        whole = ti.cast(0.0, ti.f64)
        for k in range(first[row], first[row + 1]):
            whole += value[column[k]]
        total[row] = whole


sum_rows.__module__ = "sim.cloth.sums"
as_written = ti.kernel(sum_rows)
