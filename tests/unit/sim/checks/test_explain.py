"""What `sim explain` says of a scene, and from where on a term counts as idle."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.checks.explain import Explanation, explain
from sim.spec import SimulationSpec

WATER = {
    "particle_radius": 0.01,
    "bodies": {"block": {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.1, 0]}},
}
BALL = {"shape": {"type": "sphere", "radius": 0.1}, "position": [1, 1, 0]}
SHEET = {"shape": {"type": "sheet", "size": [0.4, 0.4]}, "spacing": 0.1, "position": [0, 0.5, 0]}


def told(duration: float = 1.0, **settings) -> Explanation:
    return explain(SimulationSpec.model_validate({"fps": 24, **settings}), Path(), duration)


def subjects(lines) -> set[str]:
    return {line.subject for line in lines}


def test_a_fluid_alone():
    found = told(fluid=WATER)
    assert found.models[0].text == "1,000 particles at distances of 20 mm by WCSPH"
    assert subjects(found.leaves_out) >= {"rigid bodies", "cloth", "fluid.surface_tension", "fluid.adhesion"}
    assert "coupling" not in subjects(found.models)


@pytest.mark.parametrize(
    ("motion", "words"),
    [({}, "solids hold off the fluid"), ({"motion": "dynamic"}, "fluid and rigid bodies move each other")],
)
def test_couplings_follow_from_who_obeys_forces(motion, words):
    found = told(fluid=WATER, rigid={"bodies": {"ball": BALL | motion}})
    assert any(words in line.text for line in found.models if line.subject == "coupling")
    assert ("rigid contacts" in subjects(found.leaves_out)) == (not motion)


def test_events_count_as_there():
    event = {"at": 0.5, "add": {"rigid": {"ball": BALL | {"motion": "dynamic"}}}}
    found = told(fluid=WATER, rigid={"bodies": {"floor": {"shape": {"type": "plane"}}}}, events=[event])
    assert any("move each other" in line.text for line in found.models)


def test_viscosity_far_below_that_of_the_particles():
    """0.3 d sqrt(g H) is 0.0084 m^2/s here: a hundredth of it is the bound."""
    for viscosity, idle in [(0.0, False), (8e-5, True), (9e-5, False)]:
        found = told(fluid=WATER | {"viscosity": viscosity})
        assert ("fluid.viscosity" in subjects(found.could_leave_out)) == idle, viscosity
    assert not told(fluid=WATER | {"viscosity": 1e-9}, gravity=[0, -1e-9, 0]).could_leave_out


def test_surface_tension_that_bends_nothing_the_particles_show():
    """sqrt(sigma / (rho g)) of water is 2.7 mm."""
    for radius, idle in [(0.01, True), (0.0014, True), (0.0013, False)]:
        water = {
            "particle_radius": radius,
            "viscosity": 0,
            "surface_tension": 0.072,
            "bodies": {"drop": {"shape": {"type": "box", "size": [6 * radius] * 3}}},
        }
        found = told(fluid=water)
        assert ("fluid.surface_tension" in subjects(found.could_leave_out)) == idle, radius
    assert not told(fluid=water | {"particle_radius": 0.001}, gravity=[0, 0, 0]).could_leave_out


def test_air_that_does_not_slow_a_heavy_cloth():
    """Drag over weight at the end of a fall by H is rho C H / mass per area: 0.78 kg/m^2 here, on 0.5 m."""
    floor = {"bodies": {"floor": {"shape": {"type": "plane"}}}}
    for weight, idle in [(0.3, False), (77.0, False), (79.0, True)]:
        found = told(cloth={"sheets": {"sheet": SHEET | {"mass_per_area": weight}}, "air": {}}, rigid=floor)
        assert ("cloth.air" in subjects(found.could_leave_out)) == idle, weight
    windy = {"sheets": {"sheet": SHEET | {"mass_per_area": 1000.0}}, "air": {"wind": [1, 0, 0]}}
    assert "cloth.air" not in subjects(told(cloth=windy, rigid=floor).could_leave_out)


def test_cloth_and_fluid_that_never_meet():
    """In 0.1 s nothing falls further than 5 cm."""
    fluid = WATER | {"viscosity": 0, "solver": "dfsph"}
    for height, duration, meet in [(0.5, 1.0, True), (0.5, 0.1, False), (0.28, 0.1, True)]:
        cloth = {"sheets": {"sheet": SHEET | {"position": [0, height, 0]}}}
        found = told(duration, fluid=fluid, cloth=cloth)
        assert ("cloth and fluid" in subjects(found.could_leave_out)) == (not meet), (height, duration)
    pinned = {"sheets": {"flag": SHEET | {"position": [5, 5, 0], "pins": ["left"]}}}
    assert "cloth and fluid" in subjects(told(0.5, fluid=fluid, cloth=pinned).could_leave_out)
