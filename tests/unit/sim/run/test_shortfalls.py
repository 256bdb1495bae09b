"""What was not done as it was asked for in many steps is said, with the fields that would help."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from sim.run.reporting.counts import Counts
from sim.run.reporting.shortfalls import Work, shortfalls
from sim.spec import SimulationSpec

BALL = {"shape": {"type": "sphere", "radius": 0.1}, "position": [0, 1, 0], "motion": "dynamic", "density": 500}
WORK = Work(steps=1000, particle_steps=1_000_000, point_steps=100_000)


def spec(solver="dfsph"):
    block = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.1, 0]}
    return SimulationSpec.model_validate(
        {
            "fps": 24,
            "fluid": {"particle_radius": 0.02, "solver": solver, "bodies": {"block": block}},
            "rigid": {"bodies": {"ball": BALL}},
            "cloth": {"sheets": {"towel": {"shape": {"type": "sheet", "size": [1, 1]}, "position": [0, 2, 0]}}},
        }
    )


def said(number, *names, solver="dfsph"):
    before = Counts(**{name: 7 for name in names})
    after = replace(before, **{name: 7 + number for name in names})
    return list(shortfalls(spec(solver), before, after, WORK))


@pytest.mark.parametrize(
    ("name", "solver", "cap", "remedy"),
    [
        ("pressure_capped", "pcisph", "fluid.pcisph.max_iterations (100)", "fluid.pcisph.density_error"),
        ("pressure_capped", "iisph", "fluid.iisph.max_iterations (100)", "fluid.iisph.density_error"),
        ("pressure_capped", "dfsph", "fluid.dfsph.max_iterations (100)", "fluid.dfsph.divergence_error"),
        ("viscosity_capped", "dfsph", "fluid.implicit_viscosity.max_iterations (200)", "step.maximum"),
        ("viscosity_capped", "wcsph", "fluid.implicit_viscosity.max_iterations (200)", "step.maximum"),
        ("contacts_capped", "dfsph", "rigid.max_iterations (500)", "rigid.max_step"),
        ("cloth_capped", "dfsph", "cloth.implicit_euler.max_newton (20)", "cloth.max_step"),
    ],
)
def test_steps_that_end_at_a_cap(name, solver, cap, remedy):
    assert said(50, name, solver=solver) == []
    (text,) = said(51, name, solver=solver)
    assert cap in text and remedy in text and name in text


@pytest.mark.parametrize(
    ("name", "most", "remedy"),
    [("particles_held_off", 10_000, "particle_radius"), ("cloth_held_back", 1_000, "cloth.max_step")],
)
def test_ways_that_are_cut_short(name, most, remedy):
    assert said(most, name) == []
    (text,) = said(most + 1, name)
    assert name in text and remedy in text


def test_the_same_is_said_of_every_segment():
    """A film says once what holds of several segments."""
    assert said(100, "pressure_capped") == said(1000, "pressure_capped")


def test_a_run_of_no_step_says_nothing():
    assert list(shortfalls(spec(), Counts(), Counts(), Work(0, 0, 0))) == []


def test_it_stands_in_the_summary(simulate, capfd):
    block = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.1, 0]}
    fluid = {"particle_radius": 0.02, "solver": "iisph", "bodies": {"block": block}, "iisph": {"max_iterations": 1}}
    floor = {"shape": {"type": "plane"}, "motion": "static"}
    out = simulate({"fps": 50, "fluid": fluid, "rigid": {"bodies": {"floor": floor}}}, 2, quiet=False)
    summary = json.loads((out / "summary.json").read_text())
    assert summary["counts"]["pressure_capped"] == summary["counts"]["steps_capped"] > 0
    (text,) = summary["warnings"]
    assert "fluid.iisph.max_iterations (1)" in text
    assert capfd.readouterr().err.count(text) == 1
