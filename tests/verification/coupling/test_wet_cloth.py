"""Cloth and fluid that move each other."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.particles import read_frame, read_table, velocities
from tests.support.wet import G, below, particle_mass, point_masses, read_sheet, scene, water_at

SOLVERS = ["dfsph", pytest.param("wcsph", marks=pytest.mark.slow), pytest.param("iisph", marks=pytest.mark.slow)]
DENSITIES = [0.4, pytest.param(0.02, marks=pytest.mark.slow), pytest.param(20.0, marks=pytest.mark.slow)]
"""Mass per area [kg/m^2]; that of a layer of particles is 25."""


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize("solver", SOLVERS)
def test_momentum_goes_from_one_to_the_other(simulate, solver, density):
    """A ball of water flies into a free cloth without gravity: no momentum comes or goes."""
    ball = {"shape": {"type": "sphere", "radius": 0.08}, "position": [0.03, 0.12, 0], "velocity": [0.3, -1.5, 0]}
    sheet = {"shape": {"type": "sheet", "size": [0.4, 0.4]}, "spacing": 0.04, "mass_per_area": density,
             "thickness": 0.006}  # fmt: skip
    precise = {"implicit_euler": {"velocity_error": 1e-3, "linear_error": 1e-3}}
    out = simulate(scene(solver, ball, sheet, gravity=[0, 0, 0], cloth=precise), 8)
    masses, mass = point_masses(read_sheet(out, 0)[0], density), particle_mass()

    def momentum(frame):
        return mass * velocities(read_frame(out, frame)).sum(axis=0) + masses @ read_sheet(out, frame)[1]

    start = momentum(0)
    for frame in range(1, 9):
        assert momentum(frame) == pytest.approx(start, abs=1e-5 * np.linalg.norm(start))
    # The cloth has been set in motion, to no more than the speed of the water that meets it.
    assert masses @ read_sheet(out, 8)[1][:, 1] / masses.sum() < -0.1
    assert read_sheet(out, 8)[1][:, 1].min() > -3 * 1.5


def hammock(solver, stretch, mass_per_area, fps):
    """A layer of water on a cloth that is held all around, taut by the stretch, within walls 5 mm off."""
    water = {"shape": {"type": "box", "size": [0.55, 0.05, 0.55]}, "position": [0, 1.038, 0]}
    sheet = {"shape": {"type": "sheet", "size": [0.6, 0.6]}, "spacing": 0.05, "mass_per_area": mass_per_area,
             "position": [0, 1, 0], "stretch_stiffness": 3000, "damping": 1.0, "rest_scale": 1 / stretch,
             "thickness": 0.006, "pins": ["left", "right", "front", "back"]}  # fmt: skip
    probes = {"pins": {"type": "pin_force", "sheet": "sheet", "rate": 100}}
    walls = {"shaft": {"type": "box", "size": [0.61, 2, 0.61]}}
    thick = {"viscosity": 1e-3}
    made = scene(solver, water, sheet, probes=probes, containers=walls)
    return made | {"fps": fps, "fluid": made["fluid"] | thick}


def bears(out, since, mass_per_area):
    """Mean force of the pins since a time [s] over the weight of cloth and water."""
    table = read_table(out / "probes.csv")
    rows = (table["quantity"] == "force_y") & (table["time"] > since)
    weight = (particle_mass() * len(read_frame(out, 0)) + mass_per_area * 0.36) * G
    return table["value"][rows].mean() / weight


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_hammock_holds_water(simulate):
    """10 s: no particle is ever under the cloth, and its pins bear cloth and water."""
    out = simulate(hammock("dfsph", 1.0, 0.6, fps=10), 100)
    for frame in range(101):
        points, _, triangles = read_sheet(out, frame)
        assert below(water_at(out, frame), points, triangles) == 0
    assert bears(out, 5.0, 0.6) == pytest.approx(1.0, abs=0.02)
    assert len(read_frame(out, 100)) == len(read_frame(out, 0))


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.1, 1.0, 5.0])
@pytest.mark.parametrize("stretch", [1.0, 1.25, 1.5])
def test_it_is_tight_at_any_stretch_and_weight(simulate, stretch, ratio):
    """The density of the cloth over that of water, at a thickness of 6 mm."""
    mass_per_area = ratio * 1000 * 0.006
    out = simulate(hammock("dfsph", stretch, mass_per_area, fps=50), 50)
    for frame in range(51):
        points, _, triangles = read_sheet(out, frame)
        assert below(water_at(out, frame), points, triangles) == 0
    assert np.abs(velocities(read_frame(out, 50))).max() < np.sqrt(2 * G * 0.5)
