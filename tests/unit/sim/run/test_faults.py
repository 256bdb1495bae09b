"""What counts as a fault, from the figures of one step."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sim.fluid.measure import Measure
from sim.run.failure import MOST_STEPS, find_fault, short_step
from sim.spec import SimulationSpec

GOOD = Measure(
    v_max=1.0,
    a_max=10.0,
    pace=1.0,
    kinetic_energy=1.0,
    momentum=np.zeros(3),
    position_sum=np.zeros(3),
    density_max=1010.0,
    crowding_max=1010.0,
    pressure_max=0.0,
    height=0.0,
    compression_sum=1.0,
    not_finite=0,
    beyond_walls=0,
    too_fast=0,
    fallen=0,
)


def world(limit=1e-3, solver="wcsph", **step):
    spec = SimulationSpec.model_validate({"fluid": {"particle_radius": 0.01, "solver": solver}, "step": step})
    return SimpleNamespace(
        spec=spec,
        rigid=None,
        cloth=None,
        wet_cloth=None,
        fluid=SimpleNamespace(count=5, fastest_signal=20.0),
        step_limit=lambda measure: limit,
        limiting_term=lambda measure: ("the viscosity", "use less"),
    )


@pytest.mark.parametrize("solver", ["wcsph", "pcisph", "iisph", "dfsph"])
@pytest.mark.parametrize("change", [{"not_finite": 2}, {"crowding_max": 1310.0}, {"too_fast": 3}, {"beyond_walls": 4}])
@pytest.mark.parametrize("step", [{}, {"fixed": 1e-3}])
def test_remedies_name_settings_of_the_solver_that_runs(solver, change, step):
    here = world(solver=solver, **step)
    told = find_fault(here, replace(GOOD, **change), 1e-3)
    fields = re.findall(r"(?:fluid|step)\.[a-z_.]*[a-z]", told.remedy)
    assert {field.split(".")[1] for field in fields if field.startswith("fluid")} == {solver}
    assert ("step.fixed" in fields) is ("fixed" in step)
    assert ("step.cfl" in fields) is not ("fixed" in step)
    for field in fields:
        value = here.spec
        for key in field.split("."):
            value = getattr(value, key)
    assert solver == "wcsph" or "sound" not in told.what + told.remedy


def test_a_good_step_has_none():
    assert find_fault(world(), GOOD, 1e-3) is None
    assert find_fault(world(), None, 1e-3) is None


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"not_finite": 2}, "2 particles have values that are not finite"),
        ({"kinetic_energy": np.nan}, "not finite"),
        ({"position_sum": np.array([0, np.inf, 0])}, "not finite"),
        ({"density_max": np.nan}, "not finite"),
        ({"crowding_max": 1310.0}, "1.31 times the rest density"),
        ({"too_fast": 3}, "3 particles are faster than sound (20 m/s)"),
        ({"beyond_walls": 4}, "4 particles went through a wall"),
    ],
)
def test_faults(change, what):
    fault = find_fault(world(), replace(GOOD, **change), 1e-3)
    assert what in fault.what
    assert fault.remedy
    assert fault.repeatable
    assert not find_fault(world(fixed=1e-3), replace(GOOD, **change), 1e-3).repeatable


@pytest.mark.parametrize(("factor", "faulty"), [(2.4, False), (2.6, True)])
def test_a_fixed_step_has_a_margin(factor, faulty):
    fixed = factor * 1e-3
    assert (find_fault(world(fixed=fixed), GOOD, fixed) is not None) == faulty


@pytest.mark.parametrize(("share", "faulty"), [(1.01, False), (0.99, True)])
def test_a_step_can_be_too_short_for_a_frame(share, faulty):
    shortest = 1 / (24 * MOST_STEPS)
    fault = short_step(world(), GOOD, share * shortest, 24)
    assert (fault is not None) == faulty
    if fault:
        assert "the viscosity allows steps of" in fault.what
        assert not fault.repeatable
    assert short_step(world(fixed=1e-9), GOOD, share * shortest, 24) is None
