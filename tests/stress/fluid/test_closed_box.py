"""Nothing leaves a closed box, however it is thrown into the corners."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.stress.scenes import assert_nothing_broken, pool
from tests.support.particles import positions, read_frame, read_table

SIZE = 0.4
FRAMES = 4


def leaks(out, last):
    """How many particles lie outside the box in any frame."""
    return sum(
        int((np.abs(positions(read_frame(out, frame)) - [0, SIZE / 2, 0]).max(axis=1) > SIZE / 2).sum())
        for frame in range(last + 1)
    )


@pytest.mark.outcome("A")
@pytest.mark.parametrize(
    ("speed", "cfl"),
    [
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
    out = simulate(scene, FRAMES, threads=1)
    assert_nothing_broken(out)
    assert leaks(out, FRAMES) == 0
    assert len(read_frame(out, FRAMES)) == len(read_frame(out, 0))


@pytest.mark.parametrize("cfl", [0.4, pytest.param(0.1, marks=pytest.mark.slow)])
def test_pcisph_overshoots_at_no_wall(simulate, cfl):
    """Thrown into a corner it never presses a particle into a wall, so that no frame has to be repeated."""
    scene = pool(fps=12.5, step={"cfl": cfl}, fluid__solver="pcisph", fluid__bodies__water__velocity=[5, -4.5, 4])
    out = simulate(scene, FRAMES, threads=1)
    assert leaks(out, FRAMES) == 0
    assert json.loads((out / "summary.json").read_text())["counts"]["retries"] == 0
    assert read_table(out / "steps.csv")["density_error_max"].max() < 0.3
