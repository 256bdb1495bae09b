"""Taichi started anew, with other settings, in one process."""

from __future__ import annotations

from sim.device import runtime

COUNT = 500
STARTS = 8


def test_arrays_of_before_free_nothing_of_those_after(taichi):
    """Freed by address, they took some of the new ones with them, which were then of any shape."""
    old = []
    for threads in [1, 2] * (STARTS // 2):
        runtime.start(threads=threads, arch="cpu")
        new = [taichi.Vector.ndarray(4, taichi.f32, i + 1) for i in range(COUNT)]
        old.clear()
        old += [taichi.ndarray(taichi.f32, 5) for _ in range(COUNT)]
        wrong = [i for i, array in enumerate(new) if list(array.arr.shape) != [i + 1]]
        assert not wrong
