"""Closed forms without a container, for every pressure solver: momentum that stays, and free fall."""

from __future__ import annotations

import numpy as np
import pytest

from tests.particles import positions, read_frame, velocities
from tests.solvers import INCOMPRESSIBLE, SOLVERS, run, steps


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_collision_keeps_the_momentum(tmp_path, solver):
    """Two drops collide without gravity; pair forces are equal and opposite, so sum m v stays, to rounding."""
    ball = {"type": "sphere", "radius": 0.09}
    spec = {
        "fps": 20,
        "gravity": [0, 0, 0],
        "fluid": {
            "solver": solver,
            "particle_radius": 0.012,
            "viscosity": 1e-3,
            "bodies": {
                "left": {"shape": ball, "position": [-0.11, 0, 0], "velocity": [1.0, 0.2, 0]},
                "right": {"shape": ball, "position": [0.11, 0.03, 0.02], "velocity": [-0.5, 0, 0.1]},
            },
        },
    }
    out = run(spec, tmp_path, 6)
    first, last = velocities(read_frame(out, 0)), velocities(read_frame(out, 6))
    assert np.abs(first - last).max() > 0.5, "the drops did not collide"
    scale = np.linalg.norm(first, axis=1).sum()
    assert np.linalg.norm(last.sum(axis=0) - first.sum(axis=0)) < 1e-5 * scale


def fall(out, solver, fixed):
    """Mean position and velocity of a cube at its start and after half a second, less what is exact; duration [s]."""
    g, v0, t = np.array([0.3, -9.81, 0.0]), np.array([0.5, 2.0, -1.0]), 0.5
    spec = {
        "fps": 2,
        "gravity": g.tolist(),
        "step": {"fixed": fixed},
        "fluid": {
            "solver": solver,
            "particle_radius": 0.01,
            "bodies": {
                "cube": {
                    "shape": {"type": "box", "size": [0.1, 0.1, 0.1]},
                    "position": [0, 1.5, 0],
                    "velocity": v0.tolist(),
                }
            },
        },
    }
    run(spec, out, 1)
    first, last = read_frame(out, 0), read_frame(out, 1)
    moved = positions(last) - positions(first) - v0 * t - g * t * t / 2
    return moved, velocities(last) - v0 - g * t, g, t


def rounding(out):
    """Half a unit in the last place of coordinates and speeds below 8, at random in every step."""
    return 4.8e-7 * np.sqrt(len(steps(out)))


def test_wcsph_falls_exactly(tmp_path):
    """Velocity Verlet is exact for a constant force: x = v0 t + g t^2 / 2, v = v0 + g t."""
    place, speed, _, _ = fall(tmp_path, "wcsph", 2e-4)
    np.testing.assert_allclose(place.mean(axis=0), 0, atol=rounding(tmp_path))
    np.testing.assert_allclose(speed.mean(axis=0), 0, atol=rounding(tmp_path))


@pytest.mark.parametrize("solver", INCOMPRESSIBLE)
def test_the_incompressible_solvers_fall_as_symplectic_euler_does(tmp_path, solver):
    """v = v0 + g t exactly; n equal steps move by v0 t + g t^2 / 2 + g t dt / 2."""
    dt = 2e-3
    place, speed, g, t = fall(tmp_path, solver, dt)
    np.testing.assert_allclose(place.mean(axis=0), g * t * dt / 2, atol=rounding(tmp_path))
    np.testing.assert_allclose(speed.mean(axis=0), 0, atol=rounding(tmp_path))
    # The cube falls as a whole: no particle is pressed out of the lattice.
    assert np.abs(place - place.mean(axis=0)).max() < 0.01 * 0.02
