"""Kernels launched again without packing their arguments anew do what they would have done."""

from __future__ import annotations

import gc

import numpy as np
import pytest

from sim.device.compiler_choice import chosen

COUNT = 5
pytestmark = pytest.mark.skipif(not chosen().relaunch, reason="not with this compiler")


@pytest.fixture
def arrays(taichi):
    from tests.unit.sim.device import launched

    def make():
        one, other = taichi.ndarray(taichi.f64, COUNT), taichi.Vector.ndarray(3, taichi.f64, COUNT)
        one.fill(0.0), other.fill(0.0)
        return launched.Pack(one=one, other=other)

    return make


@pytest.fixture
def add(taichi):
    from tests.unit.sim.device import launched

    return lambda double, factor, way, table, pack: launched.add(
        double, COUNT, factor, launched.vec3(*way), table, pack
    )


@pytest.fixture
def kept(taichi):
    """How many calls are kept, of those made in a test."""
    from sim.device import launching

    launching.forget()
    return lambda: len(launching._packed)


@pytest.mark.parametrize("host", [True, False])
def test_numbers_and_vectors_change_from_call_to_call(taichi, arrays, add, kept, host):
    table, pack = np.zeros(COUNT) if host else taichi.ndarray(taichi.f64, COUNT), arrays()
    if not host:
        table.fill(0.0)
    expected, way = 0.0, np.zeros(3)
    for call in range(1, 9):
        step = np.array([call % 2, 1.0, -2.0])
        expected, way = expected + (2 if call > 6 else 1) * call, way + step
        assert add(call > 6, float(call), step, table, pack) == pytest.approx(COUNT * expected, rel=1e-15)
    assert kept() >= 2
    assert pack.one.to_numpy() == pytest.approx(np.full(COUNT, expected), rel=1e-15)
    assert pack.other.to_numpy() == pytest.approx(np.tile(way, (COUNT, 1)), rel=1e-15)


def test_what_is_freed_is_forgotten(taichi, arrays, add, kept):
    for _ in range(20):
        table, pack = taichi.ndarray(taichi.f64, COUNT), arrays()
        table.fill(0.0)
        for call in range(1, 4):
            assert add(False, 1.0, (0, 0, 0), table, pack) == call * COUNT
    assert 1 <= kept() <= 3
    del table, pack
    gc.collect()
    assert kept() == 0


def test_an_array_that_does_not_lie_whole_is_packed_by_taichi(arrays, add):
    table, pack = np.zeros(2 * COUNT)[::2], arrays()
    for _ in range(3):
        with pytest.raises(ValueError, match="contiguous"):
            add(False, 1.0, (0, 0, 0), table, pack)


def test_calls_are_kept_however_many_others_were_made_once(taichi, arrays, add, kept, monkeypatch):
    monkeypatch.setattr("sim.device.launching.MOST", 8)
    pack, tables = arrays(), [np.zeros(COUNT) for _ in range(20)]
    for table in tables:
        add(False, 1.0, (0, 0, 0), table, pack)
    before = kept()
    for _ in range(3):
        add(False, 1.0, (0, 0, 0), tables[-1], pack)
    assert kept() == before + 1
