"""Packs of one kernel may have members of the same names, and hold other packs."""

from __future__ import annotations

import numpy as np
import pytest


@pytest.fixture
def make(taichi):
    """A pack of a kind with this factor, and arrays that are filled with the others."""

    def made(kind, factor, value, size):
        values, sizes = taichi.ndarray(taichi.f64, 3), taichi.ndarray(taichi.i32, 3)
        values.fill(value), sizes.fill(size)
        return kind(factor=factor, value=values, size=sizes)

    return made


def test_like_names_are_told_apart(taichi, make):
    from tests.unit.sim.device import packed

    out = taichi.ndarray(taichi.f64, 3)
    one, same = make(packed.One, 2.0, 3.0, 1), make(packed.One, 1.0, 1.0, 5)
    for _ in range(3):
        packed.combine(one, same, make(packed.Other, 1.0, 2.0, 4), out)
        np.testing.assert_array_equal(out.to_numpy(), 6.0 + 50.0 + 800.0)


def test_a_pack_in_a_pack_is_launched_again(taichi, make):
    from tests.unit.sim.device import packed

    out = taichi.ndarray(taichi.f64, 3)
    both = packed.Both(one=make(packed.One, 1.0, 5.0, 1), out=out)
    for factor in (2.0, 3.0, 4.0):
        packed.copy(both, factor)
        np.testing.assert_array_equal(out.to_numpy(), 5.0 * factor)
