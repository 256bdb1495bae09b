"""The command `python -m workflow.foam`."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh

from common.ply import FLUID_POINT, read_points, write_mesh, write_points
from tests.support.fluid.lattices import lattice
from workflow.foam import main

SPEC = {"particle_radius": 0.01, "support_radius": 0.04, "fps": 24, "foam": {"agitation": {"low": 0.1, "high": 0.5}}}


@pytest.fixture
def simulation(tmp_path):
    """A cube of fluid that falls together for five frames."""
    folder = tmp_path / "simulation"
    folder.mkdir()
    start = 0.02 * (lattice(9, 9, 9) - 4)
    for frame in range(5):
        points = np.zeros(len(start), FLUID_POINT)
        for k, name in enumerate("xyz"):
            points[name] = start[:, k] * (1 - 0.1 * frame)
            points[f"v{name}"] = -0.1 * 24 * start[:, k] * 40
        points["id"] = np.arange(len(start))
        write_points(folder / f"fluid_{frame:05d}.ply", points)
    return folder


def make(simulation, out, frames="0:4", *more, spec=SPEC) -> int:
    words = ["--spec", json.dumps(spec), "--simulation", str(simulation), "--frames", frames, "--out", str(out)]
    return main([*words, "--arch", "cpu", *more])


def add_ball(simulation, radius=0.05):
    """A ball that stands in the middle until frame 3."""
    ball = trimesh.creation.icosphere(3, radius)
    write_mesh(simulation / "body_ball.ply", ball.vertices, ball.faces)
    rows = "".join(f"{frame},{frame / 24},ball,0,0,0,1,0,0,0,0,0,0,0,0,0\n" for frame in range(4))
    columns = "frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n"
    (simulation / "bodies.csv").write_text(columns + rows)


def within(path, radius) -> int:
    points = read_points(path)
    return int((sum(points[axis].astype(float) ** 2 for axis in "xyz") < radius**2).sum())


@pytest.mark.slow
def test_bodies_keep_foam_out_while_they_are_there(simulation, tmp_path):
    assert make(simulation, tmp_path / "free") == 0
    add_ball(simulation)
    assert make(simulation, tmp_path / "held") == 0
    for frame in range(1, 4):
        name = f"foam_{frame:05d}.ply"
        assert within(tmp_path / "free" / name, 0.049) > 20
        # The flat faces of the mesh are up to 1 % nearer than its corners.
        assert within(tmp_path / "held" / name, 0.049) == 0
    assert within(tmp_path / "held/foam_00004.ply", 0.049) > 20


def test_bodies_that_can_not_be_read_are_refused(simulation, tmp_path, capsys):
    add_ball(simulation)
    path = simulation / "bodies.csv"
    table = path.read_text()
    path.write_text(table.replace("qw", "q"))
    assert make(simulation, tmp_path / "out") == 2
    assert "bodies.csv is not a table of rigid bodies: KeyError('qw')" in capsys.readouterr().err
    path.write_text(table)
    (simulation / "body_ball.ply").write_bytes((simulation / "body_ball.ply").read_bytes()[:300])
    assert make(simulation, tmp_path / "out") == 2
    assert "body_ball.ply is not a mesh" in capsys.readouterr().err


@pytest.mark.slow
def test_segments_go_on_to_the_same_bytes(simulation, tmp_path):
    add_ball(simulation)
    assert make(simulation, tmp_path / "whole") == 0
    assert make(simulation, tmp_path / "a", "0:2") == 0
    assert make(simulation, tmp_path / "b", "3:4", "--resume", str(tmp_path / "a")) == 0
    for frame, folder in ((2, "a"), (3, "b"), (4, "b")):
        name = f"foam_{frame:05d}.ply"
        assert (tmp_path / folder / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    assert len(read_points(tmp_path / "whole/foam_00004.ply")) > 100
    assert len(read_points(tmp_path / "whole/foam_00000.ply")) == 0
    rows = json.loads((tmp_path / "whole/summary.json").read_text())["frames"]
    assert [row["particles"] for row in rows] == [row["spray"] + row["foam"] + row["bubbles"] for row in rows]


@pytest.mark.slow
def test_threads_and_seeds(simulation, tmp_path):
    assert make(simulation, tmp_path / "one") == 0
    assert make(simulation, tmp_path / "two", "0:4", "--threads", "2") == 0
    other = {**SPEC, "foam": {**SPEC["foam"], "seed": 1}}
    assert make(simulation, tmp_path / "other", spec=other) == 0
    one, two, other = ((tmp_path / name / "foam_00004.ply").read_bytes() for name in ("one", "two", "other"))
    assert one == two
    assert one != other


def test_a_limit_is_kept_and_said(simulation, tmp_path, capsys):
    spec = {**SPEC, "foam": {**SPEC["foam"], "max_particles": 50}}
    assert make(simulation, tmp_path / "out", spec=spec) == 0
    assert "no more than foam.max_particles = 50 from frame 1 on" in capsys.readouterr().out
    assert len(read_points(tmp_path / "out/foam_00004.ply")) <= 50
    assert json.loads((tmp_path / "out/summary.json").read_text())["warnings"]


def test_what_can_not_be_used_is_refused(simulation, tmp_path, capsys):
    out = tmp_path / "out"
    assert make(simulation, out, "3:4") == 2
    assert "give --resume" in capsys.readouterr().err
    assert make(simulation, out, "0:9") == 2
    assert "fluid_00005.ply is in none of" in capsys.readouterr().err
    assert make(simulation, out, spec={**SPEC, "foam": {"trapped_air": {"low": 5, "high": 5}}}) == 2
    assert "low must be below high" in capsys.readouterr().err
    assert make(simulation, out, spec={**SPEC, "foam": {"spray_below": 30}}) == 2
    assert "no count can be both" in capsys.readouterr().err
    path = simulation / "fluid_00001.ply"
    points = read_points(path).copy()
    points["vx"][7] = np.nan
    write_points(path, points)
    assert make(simulation, out) == 2
    assert "not finite" in capsys.readouterr().err
    path.write_bytes(path.read_bytes()[:-9])
    assert make(simulation, out) == 2
    assert "cut off" in capsys.readouterr().err


def test_extremes_leave_no_nan(tmp_path):
    """One particle, two in one place, speeds of 1e4 m/s, and none at all."""
    for name, positions, speed in (
        ("one", [[0, 0, 0]], 1.0),
        ("same", [[0, 0, 0], [0, 0, 0]], 3.0),
        ("fast", [[0, 0, 0], [0.01, 0, 0]], 1e4),
        ("none", np.empty((0, 3)), 0.0),
    ):
        folder = tmp_path / name
        folder.mkdir()
        for frame in range(3):
            points = np.zeros(len(positions), FLUID_POINT)
            for k, axis in enumerate("xyz"):
                points[axis] = np.array(positions)[:, k]
            points["vx"] = speed * (1 - 2 * (np.arange(len(points)) % 2))
            points["id"] = np.arange(len(points))
            write_points(folder / f"fluid_{frame:05d}.ply", points)
        assert make(folder, tmp_path / f"{name}_out", "0:2") == 0
        found = read_points(tmp_path / f"{name}_out/foam_00002.ply")
        assert all(np.isfinite(found[field]).all() for field in found.dtype.names)
