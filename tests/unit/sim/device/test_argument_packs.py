"""Packs of one kernel may have members of the same names."""

from __future__ import annotations

import numpy as np


def test_like_names_are_told_apart(taichi):
    from tests.unit.sim.device import packed

    def make(kind, factor, value, size):
        values, sizes = taichi.ndarray(taichi.f64, 3), taichi.ndarray(taichi.i32, 3)
        values.fill(value), sizes.fill(size)
        return kind(factor=factor, value=values, size=sizes)

    out = taichi.ndarray(taichi.f64, 3)
    one, same = make(packed.One, 2.0, 3.0, 1), make(packed.One, 1.0, 1.0, 5)
    for _ in range(3):
        packed.combine(one, same, make(packed.Other, 1.0, 2.0, 4), out)
        np.testing.assert_array_equal(out.to_numpy(), 6.0 + 50.0 + 800.0)
