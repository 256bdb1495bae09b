"""Kernels of cloth add in the order written."""

from __future__ import annotations

import numpy as np


def test_sums_in_order_are_those_of_a_loop(taichi):
    """Terms of which the great ones cancel: what is left of the others tells the order."""
    from tests.unit.sim.device import summed

    rng = np.random.default_rng(5)
    first = np.arange(0, 3201, 32, dtype=np.int32)
    column = rng.permutation(3200).astype(np.int32)
    value = rng.choice([1e16, -1e16, 1.0, 3.0], 3200)
    told = np.zeros(100)
    for _ in range(3):
        # The third call is launched from what is kept of the second.
        summed.as_written(first, column, value, told)
    in_turn = [0.0] * 100
    for row in range(100):
        for k in range(first[row], first[row + 1]):
            in_turn[row] += value[column[k]]
    assert told.tolist() == in_turn


def test_later_kernels_are_compiled_as_chosen(taichi):
    from tests.unit.sim.device import summed

    summed.as_written(*(np.zeros(n, kind) for n, kind in ((2, np.int32), (1, np.int32), (1, float), (1, float))))
    assert taichi.lang.impl.current_cfg().fast_math
