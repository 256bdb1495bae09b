"""Cups of many sides, filled under a tap until they run over: their walls meet in hollow edges that are turned by any
angle, lean, and end in a rim. Nothing is repeated, and nothing goes through."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh

from tests.in_time import in_time
from tests.particles import positions, read_frame
from tests.sharp_bodies import export
from tests.solvers import run

SPACING, RADIUS, HIGH = 0.02, 0.12, 0.14
CUPS = [("dfsph", 5, 0.9), *in_time(*(("dfsph", n, taper) for n, taper in ((4, 0.8), (7, 0.7), (48, 0.6))))]
OTHERS = in_time(("wcsph", 7, 0.7), ("iisph", 7, 0.7), ("pcisph", 5, 0.9))


def cup(sides: int, taper: float, wall: float) -> trimesh.Trimesh:
    """On the ground; its bottom is `taper` times as wide as its rim."""
    outer = RADIUS + wall
    outline = np.array([[0, 0], [taper * outer, 0], [outer, HIGH], [RADIUS, HIGH], [taper * RADIUS, wall], [0, wall]])
    mesh = trimesh.creation.revolve(outline, sections=sides)
    mesh.vertices = mesh.vertices[:, [1, 2, 0]]
    return mesh


@pytest.mark.parametrize(("solver", "sides", "taper"), [*CUPS, *OTHERS])
def test_a_cup_runs_over_without_a_frame_repeated(tmp_path, solver, sides, taper):
    """It holds some 3 litres; until 2 have come, nothing is outside it."""
    export(cup(sides, taper, SPACING), tmp_path / "cup.ply")
    down = [{"axis": [1, 0, 0], "angle": 180}]
    tap = {
        "shape": {"type": "disc", "radius": 2 * SPACING},
        "position": [0, 0.4, 0],
        "rotation": down,
        "rate": "5 l/s",
    }
    bodies = {"cup": {"shape": {"type": "mesh", "file": "cup.ply"}}, "floor": {"shape": {"type": "plane"}}}
    fluid = {"solver": solver, "particle_radius": SPACING / 2, "emitters": {"tap": tap}}
    run({"fps": 25, "fluid": fluid, "rigid": {"bodies": bodies}}, tmp_path, 40)
    counts = json.loads((tmp_path / "summary.json").read_text())["counts"]
    assert counts["retries"] == 0
    early, late = (positions(read_frame(tmp_path, frame)) for frame in (10, 40))
    assert (np.hypot(early[:, 0], early[:, 2]) < RADIUS).all()
    assert (np.hypot(late[:, 0], late[:, 2]) > 2 * RADIUS).any(), "it has not run over"
