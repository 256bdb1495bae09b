"""Nothing leaves a closed box, however it is thrown into the corners."""

from __future__ import annotations

import numpy as np
import pytest

from tests.particles import positions, read_frame
from tests.stress.scenes import assert_nothing_broken, pool

SIZE = 0.4
FRAMES = 4


def leaks(out, last):
    """How many particles lie outside the box in any frame."""
    return sum(
        int((np.abs(positions(read_frame(out, frame)) - [0, SIZE / 2, 0]).max(axis=1) > SIZE / 2).sum())
        for frame in range(last + 1)
    )


@pytest.mark.parametrize(
    ("speed", "cfl"),
    [
        (0.5, 0.8),
        (5.0, 0.4),
        (30.0, 0.8),
        *(pytest.param(speed, cfl, marks=pytest.mark.slow) for speed in (0.5, 5.0, 30.0) for cfl in (0.1, 0.4, 0.8)),
    ],
)
def test_nothing_leaves(simulate, cfl, speed):
    """Thrown along the diagonal, the fluid runs into every side."""
    crossing = SIZE / speed
    velocity = [speed, -0.9 * speed, 0.8 * speed]
    scene = pool(fps=1 / crossing, step={"cfl": cfl}, fluid__bodies__water__velocity=velocity)
    out = simulate(scene, FRAMES, threads=2)
    assert_nothing_broken(out)
    assert leaks(out, FRAMES) == 0
    assert len(read_frame(out, FRAMES)) == len(read_frame(out, 0))
