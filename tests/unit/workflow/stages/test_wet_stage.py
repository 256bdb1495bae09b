"""The command `python -m workflow.wet`: what fluid touches is wet, stays so with the body, and dries."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from common.ply import FLUID_POINT, read_points, write_mesh, write_points
from workflow.wet import main

RADIUS, FPS, DRYING = 0.01, 10.0, 1.0
CELL = 2 * RADIUS
FLOOR = {"normal": [0, 1, 0], "offset": 0.005}
SPEC = {"particle_radius": RADIUS, "fps": FPS, "drying_time": DRYING, "walls": [FLOOR]}
HALF = 0.1
"""Of the edge of a crate."""
FRAMES = 8
SHEET = np.array([[0.5, 0.2, 0.0], [0.6, 0.2, 0.0], [0.5, 0.2, 0.1]])


def turn(frame: int) -> Rotation:
    return Rotation.from_euler("y", 20 * frame, degrees=True)


def place(frame: int) -> np.ndarray:
    return np.array([0.0, 1.0, 0.03 * frame])


def drop(frame: int) -> np.ndarray:
    """Three drops: on top of the crate until frame 1, on the floor in frame 2, on the sheet from frame 4 on."""
    far = np.array([5.0, 5.0, 5.0])
    on_crate = turn(frame).apply([0.03, HALF + RADIUS, 0.05]) + place(frame) if frame < 2 else far
    on_floor = np.array([-1.005, RADIUS, 0.013]) if frame == 2 else far
    on_sheet = SHEET[1] + (0.0, RADIUS, 0.0) if frame >= 4 else far
    return np.stack([on_crate, on_floor, on_sheet])


@pytest.fixture
def simulation(tmp_path):
    folder = tmp_path / "simulation"
    folder.mkdir()
    box = trimesh.creation.box((2 * HALF,) * 3)
    write_mesh(folder / "body_crate.ply", box.vertices, box.faces)
    rows = ["frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"]
    for frame in range(FRAMES):
        points = np.zeros(3, FLUID_POINT)
        for axis, column in zip("xyz", drop(frame).T, strict=True):
            points[axis] = column
        write_points(folder / f"fluid_{frame:05d}.ply", points)
        write_mesh(folder / f"cloth_towel_{frame:05d}.ply", SHEET, np.array([[0, 1, 2]]))
        x, y, z, w = turn(frame).as_quat()
        numbers = (*place(frame), w, x, y, z, *(0,) * 6)
        rows.append(f"{frame},{frame / FPS},crate,{','.join(map(repr, map(float, numbers)))}")
    (folder / "bodies.csv").write_text("\n".join(rows) + "\n")
    return folder


def make(simulation, out, frames=f"0:{FRAMES - 1}", *more, spec=SPEC) -> int:
    return main(
        ["--spec", json.dumps(spec), "--simulation", str(simulation), "--frames", frames, "--out", str(out), *more]
    )


def points(out, part: str, frame: int) -> np.ndarray:
    return read_points(out / f"wet_{part}_{frame:05d}.ply")


def nodes(found: np.ndarray) -> set[tuple[int, ...]]:
    return set(zip(*(np.rint(found[axis] / CELL).astype(int).tolist() for axis in "xyz"), strict=True))


def corners(foot) -> set[tuple[int, ...]]:
    """Of the cell of the lattice that holds a point."""
    low = np.floor(np.array(foot) / CELL).astype(int)
    return {tuple(int(low[a] + k[a]) for a in range(3)) for k in np.ndindex(2, 2, 2)}


def test_it_is_wet_where_a_drop_touches_and_nowhere_else(simulation, tmp_path):
    """The drop moves with the crate: in its axes the same cell is wet, however it is turned."""
    assert make(simulation, tmp_path / "out") == 0
    for frame in range(FRAMES):
        found = points(tmp_path / "out", "body_crate", frame)
        assert nodes(found) == corners((0.03, HALF, 0.05))
    assert len(points(tmp_path / "out", "floor", 1)) == 0
    assert nodes(points(tmp_path / "out", "floor", 2)) == corners((-1.005, 0.005, 0.013))
    towel = points(tmp_path / "out", "cloth_towel", 4)
    assert towel["wet"].tolist() == [0.0, 1.0, 0.0]


def test_walls_of_containers_get_wet_from_inside(simulation, tmp_path):
    """A drop on the floor of a box that is drawn wets that, as one on any mesh does, in the axes of the world."""
    tank = trimesh.creation.box((4.0, 1.0, 4.0))
    write_mesh(simulation / "container_tank.ply", np.add(tank.vertices, (0.0, 0.505, 0.0)), tank.faces[:, ::-1])
    assert make(simulation, tmp_path / "out", spec={**SPEC, "vessels": ["tank"]}) == 0
    assert nodes(points(tmp_path / "out", "container_tank", 2)) == corners((-1.005, 0.005, 0.013))


def test_what_is_wet_dries_at_a_constant_rate(simulation, tmp_path):
    """A tenth of the drying time a frame, once the fluid is gone; to rounding of single precision."""
    assert make(simulation, tmp_path / "out") == 0
    for frame in range(FRAMES):
        wet = points(tmp_path / "out", "body_crate", frame)["wet"]
        assert wet == pytest.approx(1.0 - max(0, frame - 1) / (FPS * DRYING), abs=1e-6)
    assert (points(tmp_path / "out", "cloth_towel", FRAMES - 1)["wet"][1]) == 1.0
    spec = {**SPEC, "drying_time": 0.25}
    assert make(simulation, tmp_path / "fast", spec=spec) == 0
    counts = [len(points(tmp_path / "fast", "body_crate", frame)) for frame in range(FRAMES)]
    assert counts == [8, 8, 8, 8, 0, 0, 0, 0]


def test_parts_go_on_to_the_same_bytes(simulation, tmp_path):
    assert make(simulation, tmp_path / "whole") == 0
    assert make(simulation, tmp_path / "a", "0:2") == 0
    assert make(simulation, tmp_path / "b", f"3:{FRAMES - 1}", "--resume", str(tmp_path / "a")) == 0
    names = sorted(path.name for path in (tmp_path / "whole").glob("*.ply"))
    assert len(names) == 3 * FRAMES
    for name in names:
        folder = "a" if int(name[-9:-4]) < 3 else "b"
        assert (tmp_path / folder / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_everyday_fluid_wets_what_it_stands_on(tmp_path):
    """A layer at rest on a floor, at default settings of a scene: all under it is wet, nothing beyond two cells."""
    folder = tmp_path / "simulation"
    folder.mkdir()
    x, z = np.meshgrid(np.arange(-5, 5), np.arange(-5, 5))
    layer = np.zeros(100, FLUID_POINT)
    layer["x"], layer["y"], layer["z"] = (CELL * (x.ravel() + 0.5), 0.005 + RADIUS, CELL * (z.ravel() + 0.5))
    write_points(folder / "fluid_00000.ply", layer)
    assert make(folder, tmp_path / "out", "0:0") == 0
    found = nodes(points(tmp_path / "out", "floor", 0))
    assert {(i, 0, k) for i in range(-5, 6) for k in range(-5, 6)} <= found
    assert max(max(abs(i), abs(k)) for i, _, k in found) <= 7


def test_what_can_not_be_used_is_refused(simulation, tmp_path, capsys):
    out = tmp_path / "out"
    assert make(simulation, out, "3:4") == 2
    assert "give --resume" in capsys.readouterr().err
    assert make(simulation, out, "3:4", "--resume", str(tmp_path / "nowhere")) == 2
    assert "has no summary.json" in capsys.readouterr().err
    assert make(simulation, out, f"0:{FRAMES}") == 2
    assert f"fluid_{FRAMES:05d}.ply is in none of" in capsys.readouterr().err
    assert make(simulation, out, spec={**SPEC, "drying_time": 0}) == 2
    assert "drying_time" in capsys.readouterr().err
    assert make(simulation, out, spec={**SPEC, "vessels": ["bowl"]}) == 2
    assert "container_bowl.ply" in capsys.readouterr().err
    path = simulation / "fluid_00001.ply"
    spoiled = read_points(path).copy()
    spoiled["x"][0] = np.nan
    write_points(path, spoiled)
    assert make(simulation, out) == 2
    assert "not finite" in capsys.readouterr().err
    path.write_bytes(path.read_bytes()[:-9])
    assert make(simulation, out) == 2
    assert "cut off" in capsys.readouterr().err
