"""Cups of many sides, filled under a tap until they run over: their walls meet in hollow edges that are turned by any
angle, lean, and end in a rim. Nothing is repeated, and nothing goes through."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.support.fluid.solvers import run
from tests.support.in_time import in_time
from tests.support.particles import positions, read_frame, read_table
from tests.support.sharp_bodies import cup, export

SPACING, RADIUS, HIGH, LEVEL = 0.02, 0.12, 0.14, 0.3
CUPS = [("dfsph", 5, 0.9), *in_time(*(("dfsph", n, taper) for n, taper in ((4, 0.8), (7, 0.7), (48, 0.6))))]
TAP = {
    "shape": {"type": "disc", "radius": 2 * SPACING},
    "position": [0, 0.4, 0],
    "rotation": [{"axis": [1, 0, 0], "angle": 180}],
    "rate": "5 l/s",
}
OTHERS = in_time(("wcsph", 7, 0.7), ("iisph", 7, 0.7), ("pcisph", 5, 0.9))


@pytest.mark.slow
@pytest.mark.parametrize(("solver", "sides", "taper"), [*CUPS, *OTHERS])
def test_a_cup_runs_over_without_a_frame_repeated(tmp_path, solver, sides, taper):
    """It holds some 3 litres; when 2 have come, nothing but what splashes over its rim is outside it."""
    mesh = cup(sides, taper, RADIUS, HIGH, SPACING)
    export(mesh, tmp_path / "cup.ply")
    bodies = {"cup": {"shape": {"type": "mesh", "file": "cup.ply"}}, "floor": {"shape": {"type": "plane"}}}
    fluid = {"solver": solver, "particle_radius": SPACING / 2, "emitters": {"tap": TAP}}
    run({"fps": 25, "fluid": fluid, "rigid": {"bodies": bodies}}, tmp_path, 40)
    counts = json.loads((tmp_path / "summary.json").read_text())["counts"]
    assert counts["retries"] == 0
    early, late = (positions(read_frame(tmp_path, frame)) for frame in (10, 40))
    assert (mesh.convex_hull.contains(early) | (early[:, 1] > HIGH)).all()
    assert not mesh.contains(late).any()
    assert (np.hypot(late[:, 0], late[:, 2]) > 2 * RADIUS).any(), "it has not run over"


@pytest.mark.slow
@pytest.mark.parametrize(("sides", "taper"), [(4, 0.9), (6, 0.8)])
def test_a_hull_with_pointed_ends_is_filled_and_sinks(tmp_path, sides, taper):
    """Open, of 1.2 rho0, with walls of one spacing: it floats until it is full, and then nothing carries it; at last
    its rim is below the water's first level."""
    hull = cup(sides, taper, RADIUS, HIGH, SPACING)
    hull.apply_scale([1.7, 1, 1])
    hull.apply_translation(-hull.center_mass)
    export(hull, tmp_path / "hull.ply")
    bottom = hull.bounds[0, 1]
    tap = {**TAP, "position": [0, 0.6, 0], "start": 0.8}
    water = {"shape": {"type": "box", "size": [0.8, LEVEL, 0.6]}, "position": [0, LEVEL / 2, 0]}
    fluid = {
        "solver": "dfsph",
        "particle_radius": SPACING / 2,
        "bodies": {"water": water},
        "emitters": {"tap": tap},
    }
    body = {
        "shape": {"type": "mesh", "file": "hull.ply"},
        "motion": "dynamic",
        "density": 1200,
        "position": [0, 0.25 - bottom, 0],
    }
    tank = {"type": "box", "size": [0.8, 0.8, 0.6]}
    data = {"fps": 25, "containers": {"tank": tank}, "fluid": fluid, "rigid": {"bodies": {"hull": body}}}
    run(data, tmp_path, 90)
    assert json.loads((tmp_path / "summary.json").read_text())["counts"]["retries"] == 0
    height = read_table(tmp_path / "bodies.csv")["y"] + bottom
    print(f"{height[20]:.3f} m when the tap opens, {height[-1]:.3f} m at last")
    assert height[20] + HIGH > LEVEL
    assert height[-1] + HIGH < LEVEL - SPACING
