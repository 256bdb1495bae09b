"""Where loops run."""

import time

import pytest

from sim.device import runtime
from sim.device.arrays import IntArray, RealArray
from sim.device.compiler import ti

COUNT = 200_000


@ti.kernel
def _roots(rounds: ti.i32, found: RealArray, missed: IntArray):
    for i in range(found.shape[0]):
        value = ti.cast(i, ti.f32)
        for _ in range(rounds):
            value = ti.sqrt(value + 1.0)
        found[i] = value
    for i in range(found.shape[0]):
        if ti.abs(found[i] * found[i] - found[i] - 1.0) > 1e-5:
            ti.atomic_add(missed[0], 1)


@pytest.mark.parametrize("serial", [True, False, True])
def test_serial_loops_run_in_the_thread_that_launches_them(serial):
    """What other threads do is none of its time, but of that of the process. Roots of roots end at the golden ratio."""
    runtime.start(threads=1, arch="cpu", serial=serial)
    found, missed = ti.ndarray(ti.f32, COUNT), ti.ndarray(ti.i32, 1)
    _roots(1, found, missed)
    missed.fill(0)
    own, whole = time.thread_time(), time.process_time()
    _roots(100, found, missed)
    own, whole = time.thread_time() - own, time.process_time() - whole
    assert missed.to_numpy()[0] == 0
    if serial:
        assert own > 0.5 * whole
    else:
        assert own < 0.5 * whole
