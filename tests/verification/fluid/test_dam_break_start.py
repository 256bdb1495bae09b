"""The first moment of a dam break: the acceleration of a column that is let go at once.

The pressure p of a column of width a and height H, at rest between a wall (x = 0) and nothing (x = a), is harmonic,
zero on the free sides, and balances gravity on the floor. With k_m = (2m + 1) pi / 2a
    p = rho g sum_m 4 (-1)^m / ((2m + 1) pi k_m) cos(k_m x) sinh(k_m (H - y)) / cosh(k_m H),
so that the free side sets off with
    -1/rho dp/dx = g sum_m 4 / ((2m + 1) pi) sinh(k_m (H - y)) / cosh(k_m H),
fastest at the floor. The next order in time is a share of g t^2 / a = 0.025. `wcsph` has to build up its pressure
first, in the time that sound takes down the column, and is not tested.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.fluid.solvers import INCOMPRESSIBLE, run
from tests.support.particles import positions, read_frame, velocities
from tests.validation.dam_break import A, G, scene

ACROSS = 20
FPS = 1000.0
FROM, LAST = 5, 12
"""Frames over which the mean is taken: the pressure rings in the first of them, as it starts from nothing."""


def acceleration(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Along x [m/s^2] at the moment of the release, at points within the column [m]."""
    number = np.arange(400)[:, None]
    k = (2 * number + 1) * np.pi / (2 * A)
    fall = (np.exp(-k * y) - np.exp(-k * (4 * A - y))) / (1 + np.exp(-4 * k * A))
    return G * (4 * (-1.0) ** number / ((2 * number + 1) * np.pi) * np.sin(k * x) * fall).sum(axis=0)


@pytest.mark.parametrize("solver", INCOMPRESSIBLE)
def test_the_free_side_sets_off_as_in_potential_flow(tmp_path, solver):
    run(scene(solver, ACROSS) | {"fps": FPS}, tmp_path, LAST)
    spacing = A / ACROSS
    frames = [read_frame(tmp_path, frame) for frame in range(LAST + 1)]
    frames = [frame[np.argsort(frame["id"])] for frame in frames]
    start = positions(frames[0])
    side = (start[:, 0] > A - spacing) & (start[:, 1] > 0.15 * A) & (start[:, 1] < 1.2 * A)
    expected = acceleration(start[side, 0], start[side, 1]).mean()
    ratios = [velocities(frames[n])[side, 0].mean() * FPS / n / expected for n in range(FROM, LAST + 1)]
    print(f"{solver}: {np.mean(ratios):.3f} of the acceleration, in {len(ratios)} frames {np.round(ratios, 2)}")
    # Particles hold the free side to one spacing, and the pressure falls to zero within one of it.
    assert np.mean(ratios) == pytest.approx(1, abs=2 / ACROSS)
