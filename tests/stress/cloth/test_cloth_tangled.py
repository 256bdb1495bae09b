"""Cloth that is placed through itself, another sheet or a solid begins apart from it, or is refused by name."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scene.settings import Refused
from tests.stress.scenes import run_segment
from tests.support.bodies import box
from tests.support.cloths import passages, scene, sheet
from tests.support.crossing import crossed
from tests.support.stepping import advance

UPRIGHT = [{"axis": [0, 0, 1], "angle": 90}]
FLOOR = {"floor": {"shape": {"type": "plane"}, "position": [0, -1, 0]}}
BALL = {"shape": {"type": "sphere", "radius": 0.2}}


def crossings(world) -> int:
    """How many edges go through triangles now, by a checker of its own."""
    mesh, solids = world.cloth.mesh, world.cloth.solids
    triangles = np.concatenate([mesh.triangles, solids.triangles + mesh.count])
    return crossed(mesh.points.position.to_numpy(), triangles, np.arange(mesh.total) < mesh.count)


def stretch(world) -> np.ndarray:
    """Lengths of all springs over those as placed."""
    mesh = world.cloth.mesh
    points = mesh.points.position.to_numpy()
    length, rest = (np.linalg.norm(np.subtract(*at[mesh.ends.T]), axis=1) for at in (points, mesh.placed))
    return length / rest


def strip(path: Path, curve: np.ndarray, width: float, cells: int) -> dict:
    """A mesh with a profile [m], shape [n, 2], drawn out to a width [m]."""
    import trimesh

    z = np.linspace(-width / 2, width / 2, cells + 1)
    points = np.concatenate([np.column_stack([curve, np.full(len(curve), at)]) for at in z])
    index = np.arange(len(points)).reshape(cells + 1, len(curve))
    p, q, r, s = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    triangles = np.concatenate([np.stack([p, q, s], -1).reshape(-1, 3), np.stack([p, s, r], -1).reshape(-1, 3)])
    trimesh.Trimesh(points, triangles, process=False).export(path)
    return {"shape": {"type": "mesh", "file": str(path)}}


@pytest.mark.outcome("A")
@pytest.mark.parametrize(
    "other",
    [
        {"rotation": UPRIGHT},
        {"rotation": UPRIGHT, "position": [0.05, 0.12, 0.21]},
        {"rotation": [{"axis": [0.3, 0.2, 1], "angle": 50}], "position": [0.03, 0.1, 0.02]},
    ],
    ids=["in the middle", "in part", "aslant"],
)
def test_two_sheets_through_each_other(other):
    cloth = sheet((0.5, 0.5), spacing=0.05, thickness=0.01)
    world = scene({"one": cloth, "two": sheet((0.5, 0.5), spacing=0.043, thickness=0.01, **other)}, FLOOR)
    assert [item.sheet for item in world.untangled] == ["one", "two"]
    assert world.untangled[0].through == ["two"] and world.untangled[0].crossings > 10
    assert crossings(world) == 0
    assert stretch(world).min() > 0.9
    assert stretch(world).max() < 1.1
    assert passages(world, 0.03, 0.005) == 0
    assert crossings(world) == 0


@pytest.mark.outcome("A")
@pytest.mark.slow
def test_a_strip_that_is_rolled_through_itself(tmp_path):
    """The curve (t^3 - 3 t, t^2), which crosses itself at t = 3^(1/2)."""
    t = np.linspace(-2.1, 2.1, 2000)
    curve = 0.03 * np.column_stack([t**3 - 3 * t, t**2])
    way = np.r_[0, np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))]
    even = np.column_stack([np.interp(np.linspace(0, way[-1], 50), way, curve[:, k]) for k in range(2)])
    world = scene({"roll": strip(tmp_path / "roll.ply", even, 0.1, 8) | {"thickness": 0.004}}, FLOOR)
    assert world.untangled[0].through == ["roll"]
    assert crossings(world) == 0
    assert stretch(world).max() < 1.2
    assert passages(world, 0.03, 0.005) == 0


@pytest.mark.outcome("A")
@pytest.mark.slow
@pytest.mark.parametrize("height", [0.0, 0.07])
def test_a_sheet_through_a_ball_comes_to_lie_on_it(height):
    cloth = sheet((0.6, 0.6), spacing=0.06, thickness=0.01, position=[0, height, 0.01])
    world = scene({"cloth": cloth}, {"ball": BALL})
    assert world.untangled[0].through == ["ball"]
    assert crossings(world) == 0
    assert passages(world, 0.01, 0.005) == 0
    for k in range(3, 61):
        advance(world, 0.005, k * 0.005)
    assert crossings(world) == 0
    points = world.cloth.vertices("cloth")[0]
    # Pieces of it hang beside the ball, and none is in it.
    assert np.linalg.norm(points, axis=1).min() > 0.19
    assert points[:, 1].max() > 0.19 and points[:, 1].min() < 0.15


@pytest.mark.outcome("A")
@pytest.mark.slow
def test_a_sheet_that_the_edge_of_a_box_sticks_through():
    edge = box((0.3, 0.3, 1.0), rotation=[{"axis": [0, 0, 1], "angle": 45}]) | {"motion": "static"}
    cloth = sheet((0.6, 0.6), spacing=0.06, thickness=0.01, position=[0.01, 0.1, 0])
    world = scene({"cloth": cloth}, {"box": edge})
    assert crossings(world) == 0
    assert passages(world, 0.03, 0.005) == 0


@pytest.mark.outcome("A")
@pytest.mark.slow
def test_a_sheet_inside_a_ball_and_one_below_the_floor_come_out():
    small = sheet((0.1, 0.1), spacing=0.02, thickness=0.004, position=[0, 0.05, 0])
    low = sheet((0.3, 0.3), spacing=0.05, position=[1, -1, 0], rotation=[{"axis": [0, 0, 1], "angle": 20}])
    world = scene({"small": small, "low": low}, FLOOR | {"ball": BALL})
    assert [item.through for item in world.untangled] == [["ball"], ["floor"]]
    assert np.linalg.norm(world.cloth.vertices("small")[0], axis=1).min() > 0.2
    assert world.cloth.vertices("low")[0][:, 1].min() > -1


@pytest.mark.outcome("B")
@pytest.mark.parametrize("pins", [[{"at": [[0, 0, 0]]}], ["left", "right", "front", "back"]])
def test_a_sheet_pinned_through_a_solid_is_refused(pins):
    wide = box((2, 0.1, 2), rotation=[{"axis": [1, 0, 0], "angle": 90}]) | {"motion": "static"}
    cloth = sheet((0.6, 0.6), spacing=0.06, position=[0, 0, 0.01], pins=pins)
    with pytest.raises(Refused, match="'wide'") as refused:
        scene({"cloth": cloth}, {"wide": wide})
    assert refused.value.location[:3] == ("cloth", "sheets", "cloth")
    assert refused.value.remedy


def test_pinned_points_stay():
    cloth = sheet((0.6, 0.6), spacing=0.06, thickness=0.01, position=[0, 0.05, 0.01], pins=["left", "right"])
    world = scene({"cloth": cloth}, {"ball": BALL})
    mesh = world.cloth.mesh
    begun = mesh.points.position.to_numpy()
    assert np.array_equal(begun[: mesh.count][mesh.held], mesh.placed[: mesh.count][mesh.held])
    assert crossings(world) == 0


def test_a_tidy_cloth_begins_as_placed():
    cloth = sheet((0.6, 0.6), spacing=0.06, thickness=0.01, position=[0, 0.2005, 0])
    world = scene({"cloth": cloth, "other": cloth | {"position": [0, 0.202, 0]}}, FLOOR | {"ball": BALL})
    assert world.untangled == []
    assert np.array_equal(world.cloth.mesh.points.position.to_numpy(), world.cloth.mesh.placed)


def test_it_is_said_and_kept_and_rest_lengths_are_as_placed(tmp_path):
    settings = {"shape": {"type": "sheet", "size": [0.3, 0.3]}, "spacing": 0.05, "thickness": 0.01}
    made = {
        "fps": 100,
        "cloth": {"sheets": {"flat": settings, "across": settings | {"rotation": UPRIGHT, "position": [0, 0.03, 0]}}},
    }
    done = run_segment(made, tmp_path / "out", "0:1")
    assert done.returncode == 0, done.stderr
    said = json.loads((tmp_path / "out" / "summary.json").read_text())["untangled"]
    assert list(said) == ["flat", "across"] and "'flat'" in said["flat"] and "'across'" in said["flat"]
    assert said["flat"] in done.stdout + done.stderr
    after = run_segment(made, tmp_path / "more", "2:2", "--resume", tmp_path / "out" / "state_00001.npz")
    assert after.returncode == 0, after.stderr
    assert json.loads((tmp_path / "more" / "summary.json").read_text())["untangled"] == {}


@pytest.mark.outcome("B")
def test_a_sheet_pinned_inside_a_body_ends_with_2(tmp_path):
    settings = {"shape": {"type": "sheet", "size": [0.3, 0.3]}, "spacing": 0.05, "pins": [{"at": [[0, 0, 0]]}]}
    made = {"fps": 100, "rigid": {"bodies": {"ball": BALL}}, "cloth": {"sheets": {"flag": settings}}}
    done = run_segment(made, tmp_path / "out", "0:1")
    assert done.returncode == 2
    assert "cloth.sheets.flag.pins" in done.stderr and "'ball'" in done.stderr
