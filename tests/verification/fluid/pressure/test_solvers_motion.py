"""Closed forms without a container, for every pressure solver: momentum that stays, and free fall."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.fluid.solvers import INCOMPRESSIBLE, SOLVERS, run, steps
from tests.support.particles import positions, read_frame, velocities

G = 9.81


def collision(out, solver, **fluid):
    """Two drops that collide without gravity, as they are in frame 6; further settings of the `fluid`."""
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
            **fluid,
        },
    }
    return run(spec, out, 6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_collision_keeps_the_momentum(tmp_path, solver):
    """Pair forces are equal and opposite, so sum m v stays, to rounding."""
    check_momentum(collision(tmp_path, solver))


def check_momentum(out):
    first, last = velocities(read_frame(out, 0)), velocities(read_frame(out, 6))
    assert np.abs(first - last).max() > 0.5, "the drops did not collide"
    scale = np.linalg.norm(first, axis=1).sum()
    assert np.linalg.norm(last.sum(axis=0) - first.sum(axis=0)) < 1e-5 * scale


def fall(out, solver, fixed, **fluid):
    """Positions and velocities of a cube after half a second, less what is exact; duration [s]."""
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
            **fluid,
        },
    }
    run(spec, out, 1)
    first, last = read_frame(out, 0), read_frame(out, 1)
    moved = positions(last) - positions(first) - v0 * t - g * t * t / 2
    return moved, velocities(last) - v0 - g * t, t


def rounding(speeds: int, places: int, t: float) -> tuple[float, float]:
    """What rounding may add up to, in a place [m] and in a speed [m/s], after t [s] and so many additions to each.

    A step adds the same dt g to a speed, so that it is rounded by the same part of a unit in the last place as long as
    the speed lies between the same two powers of two: errors do not cancel, and half a unit a step is the bound. Every
    speed is under 4 m/s; dt, g and their product are rounded as well. A wrong speed moves the place, at most by t
    times the greatest error; coordinates are under 2 m. In double precision nothing of this is left but that of files.
    """
    unit = np.spacing(np.float32(1)) / 2
    speed = speeds * np.spacing(np.float32(2)) / 2 + 3 * unit * 9.81 * t
    place = t * speed + places * unit + 2 * unit * 4 * t + np.spacing(np.float32(1))
    return place, speed


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_falls_freely_does_so_exactly(tmp_path, solver):
    """x = v0 t + g t^2 / 2, v = v0 + g t; velocity Verlet changes speeds twice a step."""
    check_fall(tmp_path, fall(tmp_path, solver, 2e-4 if solver == "wcsph" else 2e-3), 2 if solver == "wcsph" else 1)


def check_fall(out, found, changes=1):
    """`found` by `fall`, where a step changes speeds so many times."""
    (place, speed, t), taken = found, len(steps(out))
    of_place, of_speed = rounding(changes * taken, taken, t)
    np.testing.assert_allclose(place.mean(axis=0), 0, atol=of_place)
    np.testing.assert_allclose(speed.mean(axis=0), 0, atol=of_speed)
    # The cube falls as a whole: no particle is pressed out of the lattice.
    assert np.abs(place - place.mean(axis=0)).max() < 0.01 * 0.02


@pytest.mark.parametrize("packing", ["lattice", "relaxed"])
@pytest.mark.parametrize("solver", INCOMPRESSIBLE)
def test_a_ball_that_is_thrown_flies_as_far_as_it_should(tmp_path, solver, packing):
    """v0 t + g t^2 / 2, in steps of any length. Disorder is pressed apart a little on the way; particles that are
    pressed go g dt t / 2 too far, and what solvers leave to be pressed is some percent of gravity at the most."""
    v0, t = np.array([2.0, 3.0, 0.0]), 0.7
    ball = {"shape": {"type": "sphere", "radius": 0.06}, "position": [0, 1.5, 0], "velocity": v0.tolist()}
    fluid = {"solver": solver, "particle_radius": 0.01, "bodies": {"ball": ball | {"packing": packing}}}
    out = run({"fps": 10, "fluid": fluid}, tmp_path, 7)
    flown = (positions(read_frame(out, 7)) - positions(read_frame(out, 0))).mean(axis=0)
    too_far = G * t * steps(out)["dt"].mean() / 2
    assert too_far > 5e-3, "steps are too short for a difference to be seen"
    np.testing.assert_allclose(flown, v0 * t - [0, G * t * t / 2, 0], rtol=0, atol=0.05 * too_far)
