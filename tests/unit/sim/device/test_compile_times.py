"""Kernels that compile are timed as such, in whatever phase they do."""

from __future__ import annotations

import time

import pytest

from common.stopwatch import Stopwatch
from sim.device import compilation


def test_the_first_call_of_a_kernel_counts(taichi):
    before = compilation.seconds()

    @taichi.kernel
    def nothing():
        pass

    nothing()
    first = compilation.seconds()
    nothing()
    assert before < first == compilation.seconds()


def test_a_phase_leaves_out_what_compiled_in_it(monkeypatch):
    watch = Stopwatch(compile=compilation.seconds)
    with watch.phase("stepping"):
        time.sleep(0.05)
        monkeypatch.setattr(compilation, "_seconds", compilation.seconds() + 0.04)
    assert watch.seconds["compile"] == pytest.approx(0.04)
    assert 0.01 <= watch.seconds["stepping"] < 0.04

    with watch.phase("compile"):
        monkeypatch.setattr(compilation, "_seconds", compilation.seconds() + 0.5)
    assert watch.seconds["compile"] < 0.5
