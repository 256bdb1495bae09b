"""Solids and fluid: what one gives the other gets, and no energy comes from a wall."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.particles import positions, read_frame, read_table, velocities

G, RHO = 9.81, 1000.0


@pytest.mark.parametrize(
    ("shape", "radius"),
    [
        ({"type": "sphere", "radius": 0.08}, 0.08),
        pytest.param({"type": "box", "size": [0.16, 0.16, 0.16]}, 0.08, marks=pytest.mark.slow),
    ],
    ids=["sphere", "box"],
)
@pytest.mark.parametrize(
    ("damping", "settings", "share"),
    # Damping and viscosity depend on the velocity, which the solver takes at half the step, or at its end, and the
    # trapezoidal rule at both ends: first order.
    [
        (0.0, {}, 0.002),
        pytest.param(1.0, {}, 0.05, marks=pytest.mark.slow),
        pytest.param(0.0, {"adhesion": 20}, 0.002, marks=pytest.mark.slow),
        pytest.param(0.0, {"viscosity": 0.05, "viscosity_solver": "explicit"}, 0.05, marks=pytest.mark.slow),
        (0.0, {"viscosity": 0.05, "viscosity_solver": "implicit"}, 0.05),
    ],
    ids=["pressure", "damping", "adhesion", "explicit", "implicit"],
)
def test_the_impulse_on_a_body_is_the_momentum_that_the_fluid_loses(simulate, shape, radius, damping, settings, share):
    """Without gravity: sum m (v0 - v1) = integral of the force on the body dt, here by the trapezoidal rule, which is
    what velocity Verlet does."""
    r, speed = 0.01, 4.0
    spec = {
        "fps": 40,
        "gravity": [0, 0, 0],
        "fluid": {
            "particle_radius": r,
            "wcsph": {"wall_damping": damping},
            **settings,
            "bodies": {
                "drop": {
                    "shape": {"type": "box", "size": [0.08, 0.08, 0.08]},
                    "position": [0, radius + 0.05, 0.01],
                    "velocity": [0, -speed, 0],
                }
            },
        },
        "rigid": {"bodies": {"target": {"shape": shape}}},
        "probes": {"push": {"type": "force", "body": "target", "rate": 1e6}},
    }
    out = simulate(spec, 3)
    table = read_table(out / "probes.csv")
    steps = read_table(out / "steps.csv")
    before, after = velocities(read_frame(out, 0)), velocities(read_frame(out, 3))
    mass = RHO * (2 * r) ** 3
    for axis, name in enumerate("xyz"):
        push = table["value"][table["quantity"] == f"force_{name}"]
        impulse = float((steps["dt"] * (push[1:] + push[:-1]) / 2).sum())
        lost = mass * float((before - after)[:, axis].sum())
        assert impulse == pytest.approx(lost, abs=share * mass * len(before) * speed)
    assert abs(velocities(read_frame(out, 3))[:, 1].mean()) < 0.9 * speed, "the drop did not hit"


@pytest.mark.parametrize("solver", ["iisph", "dfsph"])
def test_the_impulse_of_an_impact_is_what_all_its_pressures_give(simulate, solver):
    """sum m (v0 - v1) = sum over the steps of the force on the body times dt.

    At this speed a step presses particles so far that they are looked at twice, and pressed twice. The lists of the
    solver are those of the start of a step, without what comes into reach during it: hence the tolerance.
    """
    r, speed = 0.01, 4.0
    drop = {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "position": [0, 0.11, 0], "velocity": [0, -speed, 0]}
    spec = {
        "fps": 100,
        "gravity": [0, 0, 0],
        "fluid": {"solver": solver, "particle_radius": r, "viscosity": 0, "bodies": {"drop": drop}},
        "rigid": {"bodies": {"target": {"shape": {"type": "box", "size": [0.2, 0.1, 0.2]}}}},
        "probes": {"push": {"type": "force", "body": "target", "rate": 1e6}},
    }
    out = simulate(spec, 2)
    table, steps = read_table(out / "probes.csv"), read_table(out / "steps.csv")
    before, after = velocities(read_frame(out, 0)), velocities(read_frame(out, 2))
    mass = RHO * (2 * r) ** 3
    for axis, name in enumerate("xyz"):
        push = table["value"][table["quantity"] == f"force_{name}"]
        lost = mass * float((before - after)[:, axis].sum())
        assert float((steps["dt"] * push[1:]).sum()) == pytest.approx(lost, abs=0.015 * mass * len(before) * speed)
    assert abs(after[:, 1].mean()) < 0.5 * speed, "the drop did not hit"


def test_a_pool_without_friction_gains_no_energy(simulate):
    """Kinetic and potential energy together stay what they were; the rest is what the corners held at first."""
    side = 0.2
    spec = {
        "fps": 10,
        "containers": {"tank": {"type": "box", "size": [side, 1, side]}},
        "fluid": {
            "particle_radius": 0.01,
            "viscosity": 0,
            "wcsph": {"artificial_viscosity": 0, "wall_damping": 0},
            "bodies": {"water": {"shape": {"type": "box", "size": [side, side, side]}, "position": [0, side / 2, 0]}},
        },
    }
    out = simulate(spec, 6)
    table = read_table(out / "steps.csv")
    energy = table["kinetic_energy"] + table["potential_energy"]
    weight = RHO * side**3 * G * side / 2
    assert energy.max() < 1.01 * weight
    assert energy.min() > 0.97 * weight


@pytest.mark.parametrize("surface_tension", [0.0, 0.07])
def test_surface_tension_rounds_a_cube_off(simulate, surface_tension):
    """Corners of a cube are sqrt(3) times as far from its centre as its faces; of a ball, as near."""
    spec = {
        "fps": 20,
        "gravity": [0, 0, 0],
        "fluid": {
            "particle_radius": 0.0005,
            "viscosity": 1e-5,
            "surface_tension": surface_tension,
            "wcsph": {"speed_of_sound": 3.0, "artificial_viscosity": 0.3},
            "bodies": {"cube": {"shape": {"type": "box", "size": [0.01, 0.01, 0.01]}}},
        },
    }
    out = simulate(spec, 2)
    first, last = (np.linalg.norm(positions(read_frame(out, frame)), axis=1).max() for frame in (0, 2))
    ball = (3 / (4 * np.pi)) ** (1 / 3) * 0.01
    if surface_tension:
        assert last - ball < 0.5 * (first - ball)
    else:
        assert last == pytest.approx(first, rel=0.05)
