"""A shell of finite elements at the extremes, by the measures of `test_cloth_extremes.py`: table in docs/cloth.md."""

from __future__ import annotations

import numpy as np
import pytest

from sim.cloth.fabrics import MEASURED
from tests.stress.cloth.test_cloth_extremes import (
    MOST_SUBSTEPS,
    ROUNDING,
    SIZE,
    STEPS,
    SWING,
    decades,
    energy,
    falls_right,
    highest_energy,
    middle,
    segment,
    square,
)
from tests.support.bodies import box
from tests.support.cloths import INTEGRATORS, part, passages, scene, sheet
from tests.support.in_time import in_time

GAINS = SWING | {"symplectic_euler": 0.69}
"""Symplectic Euler keeps an energy that differs from the true one by dt dU/dt / 2: for the fastest swing in the steps
that it takes, 0.69 of the longest stable ones, by 0.69 of what swings. Springs have more damping by default."""


def shell(integrator, gravity=(0, -9.81, 0), **settings):
    return part({"sheet": square(**settings)}, model="fem", integrator=integrator, gravity=gravity)


@pytest.mark.outcome("A")
@pytest.mark.parametrize(
    ("integrator", "dt", "stiffness"),
    [
        *((name, dt, stiffness) for name in INTEGRATORS for dt, stiffness in ((1e-3, 1.0), (1e-3, 1e8), (1 / 30, 1.0))),
        *((name, 1 / 30, 1e8) for name in ("implicit_euler", "xpbd")),
        *in_time(("symplectic_euler", 1 / 30, 1e8)),
        *in_time(*((name, dt, stiffness) for name in INTEGRATORS for dt in STEPS for stiffness in (1e2, 1e4, 1e6))),
        *in_time(*((name, 1e-5, stiffness) for name in INTEGRATORS for stiffness in (1.0, 1e8))),
    ],
)
def test_any_stiffness_and_step(integrator, dt, stiffness):
    made = shell(integrator, stretch_stiffness=stiffness, rest_scale=0.9)
    falls_right(made, dt, 30, GAINS[integrator])


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("mass", decades([1e-6, 1e6], [1e-4, 1e2]))
def test_any_mass(integrator, mass):
    falls_right(shell(integrator, mass_per_area=mass, rest_scale=0.9), 1e-3, 30, GAINS[integrator])


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("bend", [1e3, *in_time(0.0, 1e-9)])
def test_any_bending(integrator, bend):
    """From none to that of a board; moments of the stiffest are rounded to more than a taut sheet of it stores."""
    made = shell(integrator, bend_stiffness=bend, rest_scale=0.9)
    falls_right(made, 1e-3, 30, max(GAINS[integrator], 1e-6))


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("dt", decades([1 / 30], [1e-3]))
@pytest.mark.parametrize("delay", [0.0, 10.0])
def test_no_damping_and_the_most(integrator, dt, delay):
    fabric = {"damping_time": delay, "bend_damping_time": delay}
    made = shell(integrator, fabric=fabric, stretch_stiffness=1e2, bend_stiffness=0.01, rest_scale=0.9)
    if dt / getattr(made.integrator, "stable", dt) > MOST_SUBSTEPS:
        pytest.skip("a run refuses so many explicit steps")
    falls_right(made, dt, 30, GAINS[integrator] if delay == 0 else ROUNDING)


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", ["implicit_euler", *in_time("symplectic_euler", "xpbd")])
@pytest.mark.parametrize(
    "fabric", decades(["denim", "jersey"], [name for name in MEASURED if name not in ("denim", "jersey")])
)
def test_each_fabric(integrator, fabric):
    falls_right(shell(integrator, fabric=fabric, rest_scale=0.9), 1e-3, 30, GAINS[integrator])


@pytest.mark.outcome("A")
@pytest.mark.parametrize(
    ("integrator", "stiffness", "dt"),
    [("implicit_euler", 1e4, 1 / 30), *in_time(*(("implicit_euler", 1e8, dt) for dt in (1e-3, 1 / 30)))],
)
def test_three_hundred_percent_of_stretch(integrator, stiffness, dt):
    """It comes back to its length at rest, where it may crumple, and its energy is gone, all but a hundredth."""
    made = shell(integrator, gravity=(0, 0, 0), stretch_stiffness=stiffness, rest_scale=0.25)
    before, start = energy(made), middle(made)
    assert made.measure().stretch_max == pytest.approx(4)
    assert highest_energy(made, dt, 40) <= before
    assert energy(made) < 1e-2 * before
    assert np.abs(middle(made) - start).max() < 1e-6 * SIZE


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", ["implicit_euler", *in_time("xpbd", "symplectic_euler")])
def test_nothing_passes_through_it(integrator):
    edge = box((0.4, 0.4, 1.4), position=[0, 0.5, 0], rotation=[{"axis": [0, 0, 1], "angle": 45}])
    cloth = sheet((1.0, 1.0), spacing=0.1, position=[0, 0.82, 0], thickness=0.01, fabric="denim")
    bodies = {"floor": {"shape": {"type": "plane"}}, "box": edge | {"motion": "static"}}
    world = scene({"cloth": cloth}, bodies, cloth={"integrator": integrator, "model": "fem"})
    assert passages(world, 0.5, 0.005) == 0
    assert np.abs(world.cloth.vertices("cloth")[0][:, 0].mean()) < 0.05


@pytest.mark.outcome("B")
@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"rest_scale": 0}, "rest_scale"),
        ({"shear_stiffness": 0}, "shear_stiffness"),
        ({"fabric": {"poisson_ratio": 3}}, "poisson_ratio"),
        ({"fabric": {"warp_stiffness": 0}}, "warp_stiffness"),
        ({"fabric": {"bias_bending": 0}}, "bias_bending"),
        ({"fabric": {"damping_time": -1}}, "damping_time"),
        ({"fabric": {"warp": [0, 0, 0]}}, "warp must not be zero"),
        ({"fabric": "silk"}, "denim"),
    ],
)
def test_what_a_shell_can_not_be(tmp_path, capsys, change, told):
    status, out = segment(tmp_path, cloth={"model": "fem"}, sheet=change)
    said = capsys.readouterr().err
    assert status == 2, said
    assert told in said
    assert not list(out.glob("*.ply"))
