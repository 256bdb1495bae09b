"""Runs of scenes with cloth: in two parts, repeated, with events, and where solids leave no room."""

from __future__ import annotations

import numpy as np
import pytest

from tests.stress.scenes import contents, failure, run_segment

BALL = {"shape": {"type": "sphere", "radius": 0.1}, "position": [0, 0.1, 0]}
SHEET = {"shape": {"type": "sheet", "size": [0.4, 0.4]}, "spacing": 0.05, "position": [0, 0.215, 0], "thickness": 0.01}
LED = {"at": [[0.2, 0.215, 0.2]], "keyframes": [{"at": 0}, {"at": 0.05, "offset": [0, 0.02, 0]}]}


def scene(integrator="implicit_euler", model="springs", **changes):
    """A sheet over a ball, held by a corner that is led."""
    cloth = {"sheets": {"sheet": SHEET | {"pins": [LED]}}, "integrator": integrator, "air": {"wind": [1, 0, 0]}}
    cloth["model"] = model
    return {"fps": 100, "cloth": cloth, "rigid": {"bodies": {"ball": BALL}}} | changes


@pytest.mark.parametrize("model", ["springs", "fem"])
@pytest.mark.parametrize("integrator", ["implicit_euler", "symplectic_euler", "xpbd"])
def test_two_parts_are_the_whole(simulate, integrator, model):
    made = scene(integrator, model, events=[{"at": 0.035, "set": {"cloth.sheets.sheet.pins": []}}])
    whole = simulate(made, 8, "whole")
    first = simulate(made, 5, "first")
    second = simulate(made, 8, "second", first=6, state=first / "state_00005.npz")
    assert contents(first, "cloth_*.ply") | contents(second, "cloth_*.ply") == contents(whole, "cloth_*.ply")
    assert contents(second, "state_00008.npz") == contents(whole, "state_00008.npz")


def test_a_pin_that_is_let_go_falls(simulate):
    out = simulate(scene("xpbd", events=[{"at": 0.02, "set": {"cloth.sheets.sheet.pins": []}}],
                         probes={"corner": {"type": "vertex", "sheet": "sheet", "vertex": 80}}), 12, "out")  # fmt: skip
    rows = [line.split(",") for line in (out / "probes.csv").read_text().splitlines()[1:]]
    heights = [float(row[3]) for row in rows if row[2] == "position_y"]
    assert heights[1] == pytest.approx(0.219, abs=1e-6)
    assert heights[-1] < heights[2] < 0.2231


@pytest.mark.slow
@pytest.mark.outcome("C")
def test_solids_that_leave_no_room_stop_the_run(tmp_path):
    plate = {"shape": {"type": "box", "size": [0.6, 0.1, 0.6]}}
    falling = plate | {"motion": "prescribed", "position": [0, 0.08, 0], "velocity": [0, -1, 0]}
    made = {
        "fps": 100,
        "rigid": {"bodies": {"low": plate | {"position": [0, -0.06, 0]}, "high": falling}},
        "cloth": {"sheets": {"sheet": SHEET | {"position": [0, 0, 0], "spacing": 0.1}}},
    }
    done = run_segment(made, tmp_path / "out", "0:6")
    assert done.returncode == 3, done.stderr
    assert "through cloth" in failure(tmp_path / "out")["detected"]


@pytest.mark.outcome("C")
def test_pins_that_lead_corners_through_one_another_stop_the_run(tmp_path):
    """Two corners of a folded cloth change their order on straight ways, which cross."""
    high, low = 0.2, 0.1
    pins = [
        {
            "at": [[side, 0, 0.2]],
            "keyframes": [
                {"at": 0},
                {"at": 0.1, "offset": [-side, before, 0]},
                {"at": 0.2, "offset": [-side, after, 0]},
            ],
        }
        for side, before, after in ((0.2, high, low), (-0.2, low, high))
    ]
    made = {"fps": 100, "cloth": {"sheets": {"sheet": SHEET | {"position": [0, 0, 0], "pins": pins}}}}
    done = run_segment(made, tmp_path / "out", "0:20")
    assert done.returncode == 3, done.stderr
    assert "through cloth" in failure(tmp_path / "out")["detected"]


def test_frames_hold_meshes_with_velocities(simulate):
    import trimesh

    out = simulate(scene(), 3, "out")
    mesh = trimesh.load_mesh(out / "cloth_sheet_00003.ply", process=False)
    data = mesh.metadata["_ply_raw"]["vertex"]["data"]
    assert len(mesh.vertices) == 81
    assert np.isfinite([data[name] for name in ("vx", "vy", "vz")]).all()
