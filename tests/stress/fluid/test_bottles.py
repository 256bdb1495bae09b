"""A bottle that stands on its head, or is turned over, runs empty.

Where shoulder and neck meet its surface is hollow around the axis and bulges along it, and its neck is five spacings
wide: as particles go on, other faces of the mesh come into sight.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh

from tests.support.fluid.solvers import run
from tests.support.particles import positions, read_frame, velocities
from tests.support.sharp_bodies import export

SPACING, WALL = 0.005, 0.0015
BODY, NECK, SHOULDER, MOUTH = 0.03, 0.012, (0.12, 0.16), 0.2
"""Radii, and heights above the bottom while it stands [m]."""
STAND = 0.3
"""Height of its bottom while it stands on its head [m]."""


def bottle(sides: int) -> trimesh.Trimesh:
    """Standing, open above."""
    outer = [[0, 0], [BODY + WALL, 0], [BODY + WALL, SHOULDER[0]], [NECK + WALL, SHOULDER[1]], [NECK + WALL, MOUTH]]
    inner = [[NECK, MOUTH], [NECK, SHOULDER[1]], [BODY, SHOULDER[0]], [BODY, WALL], [0, WALL]]
    mesh = trimesh.creation.revolve(np.array(outer + inner), sections=sides)
    mesh.vertices = mesh.vertices[:, [1, 2, 0]]
    return mesh


@pytest.mark.slow
@pytest.mark.parametrize(
    ("solver", "sides", "lean"), [("dfsph", 48, 5), ("dfsph", 20, 0), ("iisph", 48, 5), ("wcsph", 48, 5)]
)
def test_a_bottle_runs_empty_without_a_frame_repeated(tmp_path, solver, sides, lean):
    """Nothing goes through it, and nothing comes out faster than what has fallen from where the water began."""
    mesh = bottle(sides)
    mesh.vertices = mesh.vertices * [1, -1, 1] + [0, STAND, 0]
    export(mesh, tmp_path / "bottle.ply")
    turned = {"rotation": [{"axis": [0, 0, 1], "angle": lean}]}
    shape = {"type": "mesh", "file": "bottle.ply", "anchor": "origin"}
    high = 0.09
    center = trimesh.transformations.rotation_matrix(np.deg2rad(lean), [0, 0, 1]) @ [0, STAND - WALL - high / 2, 0, 1]
    water = {"shape": {"type": "cylinder", "radius": BODY, "height": high}, "position": center[:3].tolist(), **turned}
    fluid = {"solver": solver, "particle_radius": SPACING / 2, "bodies": {"water": water}}
    run({"fps": 30, "fluid": fluid, "rigid": {"bodies": {"bottle": {"shape": shape, **turned}}}}, tmp_path, 24)
    counts = json.loads((tmp_path / "summary.json").read_text())["counts"]
    assert counts["retries"] == 0
    mesh.apply_transform(trimesh.transformations.rotation_matrix(np.deg2rad(lean), [0, 0, 1]))
    frame = read_frame(tmp_path, 24)
    points, speed = positions(frame), np.linalg.norm(velocities(frame), axis=1)
    assert not mesh.contains(points).any()
    outside = ~mesh.convex_hull.contains(points)
    assert outside.mean() > 0.2, "it has not run out"
    assert points[outside, 1].max() < mesh.bounds[0, 1] + 2 * SPACING
    fallen = mesh.bounds[1, 1] - points[:, 1]
    assert (speed < 1.1 * np.sqrt(2 * 9.81 * fallen)).all()


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["dfsph", "iisph"])
def test_a_bottle_is_turned_over_without_a_frame_repeated(tmp_path, solver):
    """As a cook does it, within 0.7 s, over a sink; in the end it is empty and all of the water is there."""
    export(bottle(48), tmp_path / "bottle.ply")
    over = [{"axis": [0, 0, 1], "angle": -175}]
    body = {
        "shape": {"type": "mesh", "file": "bottle.ply", "anchor": "origin"},
        "motion": "prescribed",
        "keyframes": [{"at": 0.3, "position": [0, 0.3, 0]}, {"at": 1.0, "position": [0, 0.3, 0], "rotation": over}],
    }
    water = {"shape": {"type": "cylinder", "radius": BODY, "height": 0.11}, "position": [0, 0.3 + WALL + 0.055, 0]}
    fluid = {"solver": solver, "particle_radius": SPACING / 2, "bodies": {"water": water}}
    sink = {"type": "box", "size": [0.4, 0.5, 0.4], "open": ["top"]}
    data = {"fps": 30, "containers": {"sink": sink}, "fluid": fluid, "rigid": {"bodies": {"bottle": body}}}
    run(data, tmp_path, 70)
    summary = json.loads((tmp_path / "summary.json").read_text())["counts"]
    assert summary["retries"] == 0
    points = positions(read_frame(tmp_path, 70))
    assert len(points) == summary["particles_started"]
    assert points[:, 1].max() < 0.1
