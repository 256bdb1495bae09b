"""Vessels modelled as surfaces without thickness, made shells: water stays in them, and they fall as shells do."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scene.settings import Refused
from tests.support.bodies import G, ground, part, step, tilt
from tests.support.fluid.solvers import run
from tests.support.in_time import in_time
from tests.support.meshes import write
from tests.support.particles import positions, read_frame
from tests.support.surfaces import bowl

RADIUS, SPACING, FPS, FRAMES = 0.15, 0.02, 24, 12


def vessel(folder: Path, **shape) -> dict:
    return {"type": "mesh", "file": write(folder / "bowl.off", bowl(RADIUS)).name, **shape}


@pytest.mark.outcome("A")
@pytest.mark.parametrize("speed", [0.0, *in_time(0.5)])
def test_water_stays_in_a_bowl_a_tenth_of_a_particle_thick(tmp_path, speed):
    """It is poured into a third of the bowl, slumps and swings; where the bowl moves, water and bowl begin with its
    velocity. Nothing is ever outside the sphere of the bowl."""
    moving = {"motion": "prescribed", "velocity": [speed, 0, 0]} if speed else {}
    water = {
        "shape": {"type": "cylinder", "radius": 0.08, "height": 0.06},
        "position": [0, -0.085, 0],
        "velocity": [speed, 0, 0],
    }
    scene = {
        "fps": FPS,
        "fluid": {"solver": "dfsph", "particle_radius": SPACING / 2, "bodies": {"water": water}},
        "rigid": {"bodies": {"bowl": {"shape": vessel(tmp_path, thickness=SPACING / 10), **moving}}},
    }
    run(scene, tmp_path, FRAMES)
    counts = json.loads((tmp_path / "summary.json").read_text())["counts"]
    for frame in range(FRAMES + 1):
        at = positions(read_frame(tmp_path, frame)) - [speed * frame / FPS, 0, 0]
        assert len(at) == counts["particles_started"] > 100
        assert (np.linalg.norm(at, axis=1) < RADIUS).all()


@pytest.mark.outcome("A")
def test_a_bowl_that_falls_comes_to_rest_on_its_shell(tmp_path):
    """y = y0 - g t^2 / 2 of its centre of mass, and then its outer side on the ground: by half of its thickness lower
    than the surface. Bodies may overlap by 1.1e-4 of their size."""
    thick = 0.02
    vessel(tmp_path)
    shape = {"type": "mesh", "file": str(tmp_path / "bowl.off"), "thickness": thick}
    bodies = part(
        {"bowl": {"motion": "dynamic", "shape": shape, "position": [0, 0.3, 0], "density": 500.0}, "floor": ground()}
    )
    inner, outer = RADIUS - thick / 2, RADIUS + thick / 2
    mass = 500 * 2 / 3 * np.pi * (outer**3 - inner**3)
    below = 3 / 8 * (outer**4 - inner**4) / (outer**3 - inner**3)
    # The polyhedron of 96 by 24 faces lacks 2e-3 of the volume.
    assert bodies.mass[0] == pytest.approx(mass, rel=3e-3)
    start = bodies.position[0].copy()
    assert start[1] == pytest.approx(0.3 - below, abs=1e-3 * RADIUS)
    step(bodies, 0.15)
    assert bodies.position[0] == pytest.approx([0, start[1] - G * 0.15**2 / 2, 0], abs=1e-6)
    step(bodies, 1.0)
    assert bodies.position[0][1] == pytest.approx(outer - below, abs=2e-3 * RADIUS)
    assert tilt(bodies) < 0.02


@pytest.mark.outcome("B")
def test_without_a_thickness_it_is_refused(simulate, tmp_path):
    shape = vessel(tmp_path)
    with pytest.raises(Refused, match=r"an opening 0\.3 wide") as refused:
        simulate({"fps": 24, "rigid": {"bodies": {"bowl": {"shape": shape}}}}, 1)
    assert refused.value.location == ("rigid", "bodies", "bowl", "shape", "file")
    assert "`thickness`" in refused.value.remedy
    assert not list(tmp_path.glob("run/*.npz"))
