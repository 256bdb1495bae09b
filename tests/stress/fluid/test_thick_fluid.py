"""Implicit viscosity, surface tension, adhesion and XSPH together: same bytes, and no silent end of the iterations."""

from __future__ import annotations

import json

import numpy as np
import pytest

from sim.fluid.forces.velocity_smoothing import viscosity_is_implicit
from sim.fluid.spec import Fluid
from tests.stress.scenes import THICK, contents, pool, run_segment
from tests.support.fluid.solvers import SOLVERS
from tests.support.particles import read_table

BALL = {"motion": "static", "shape": {"type": "sphere", "radius": 0.08}, "position": [0.05, 0.06, 0]}
THICK_ON_A_BALL = THICK | {"rigid__bodies": {"ball": BALL}}


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_resumed_run_and_other_threads_give_the_same_bytes(tmp_path, solver):
    scene = pool(fluid__solver=solver, **THICK_ON_A_BALL)
    whole, first, second = (tmp_path / name for name in ("whole", "first", "second"))
    for folder, frames, options in (
        (whole, "0:8", ("--threads", 1)),
        (first, "0:4", ("--threads", 2)),
        (second, "5:8", ("--threads", 2, "--resume", first / "state_00004.npz")),
    ):
        done = run_segment(scene, folder, frames, *options)
        assert done.returncode == 0, done.stderr
    for pattern in ("fluid_*.ply", "state_00008.npz"):
        parts = (contents(first, pattern) if "fluid" in pattern else {}) | contents(second, pattern)
        assert parts == contents(whole, pattern)
    assert read_table(whole / "steps.csv")["viscosity_iterations"].max() > 0


@pytest.mark.parametrize(
    ("viscosity", "solver", "chosen"),
    [
        (1e-6, "dfsph", False),
        (7e-3, "dfsph", True),
        (1e-6, "wcsph", False),
        (4e-3, "wcsph", False),
        (10, "wcsph", True),
    ],
)
def test_the_viscosity_solver_that_allows_longer_steps_is_chosen(viscosity, solver, chosen):
    """Water and honey, with signals of 0.5 m/s or, in wcsph, 5 m/s; nothing is chosen against a clear word."""
    fluid = Fluid(particle_radius=0.01, viscosity=viscosity, solver=solver)
    gravity, signal = np.array([0, -9.81, 0]), 5.0 if solver == "wcsph" else 0.5
    assert viscosity_is_implicit(fluid, gravity, signal) is chosen
    for word in ("explicit", "implicit"):
        asked = fluid.model_copy(update={"viscosity_solver": word})
        assert viscosity_is_implicit(asked, gravity, signal) is (word == "implicit")


def test_iterations_that_end_too_soon_are_counted(tmp_path):
    scene = pool(fluid__solver="dfsph", fluid__implicit_viscosity={"max_iterations": 1}, **THICK_ON_A_BALL)
    done = run_segment(scene, tmp_path, "0:4")
    assert done.returncode == 0, done.stderr
    iterations = read_table(tmp_path / "steps.csv")["viscosity_iterations"]
    assert iterations.max() == 1
    capped = json.loads((tmp_path / "summary.json").read_text())["counts"]["steps_capped"]
    assert capped >= (iterations == 1).sum() / 2
