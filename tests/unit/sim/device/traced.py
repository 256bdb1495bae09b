"""Kernels for `test_tracing.py`: they cannot be in a file with postponed annotations."""

from sim.device.compiler import ti


@ti.func
def doubled(x: ti.f64) -> ti.f64:
    found = ti.cast(0.0, ti.f64)
    if x > 0.0:
        found = 2.0 * x
    return found


@ti.kernel
def twice(x: ti.f64) -> ti.f64:
    total = ti.cast(0.0, ti.f64)
    for _ in range(1):
        total = doubled(doubled(x)) + 0.0 * (
            doubled(x)
            + doubled(x)
            + ti.cast(0.0, ti.f64) * ti.cast(1.0, ti.f64) * ti.cast(2.0, ti.f64) * ti.cast(3.0, ti.f64) * x
        )
    return total


@ti.kernel
def thrice(x: ti.f64) -> ti.f64:
    return doubled(doubled(doubled(x)))


@ti.kernel
def wrong():
    x = unknown_name + 1  # noqa: F821
    print(x)


class Scaled:
    @ti.func
    def by_two(self, x):
        return 2.0 * x
