"""OpenVDB files, opened again by Blender and by its library: sums over cells are those over particles."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from common.ply import FLUID_POINT, write_points
from sim.foam.particles import FOAM_POINT

ROOT = Path(__file__).resolve().parents[3]
RADIUS = 0.01
FPS = 10
LOOK = """
import bpy, json, os, sys
import numpy as np
from render.blender.versions import openvdb
path = sys.argv[-1]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.object.volume_import(filepath=path)
volume = bpy.context.object.data
volume.grids.load()
found = {"blender": sorted(grid.name for grid in volume.grids)}
grids, metadata = openvdb().readAll(path)
own = {grid.name: grid for grid in grids}
for kind in ("density", "foam"):
    if kind in own:
        cells = [(value.min, value.max, value.value) for value in own[kind].iterOnValues()]
        assert all(low == high for low, high, _ in cells)
        size = own[kind].transform.voxelSize()[0]
        places = np.array([low for low, _, _ in cells]) * size
        share = np.array([value for _, _, value in cells]) * size**3
        sums = {"volume": share.sum(), "moment": (share @ places).tolist(), "cells": len(cells)}
        for name, grid in own.items() if kind == "density" else ():
            if name not in ("density", "foam"):
                access = grid.getConstAccessor()
                values = np.array([access.getValue(low) for low, _, _ in cells])
                sums[name] = (share @ values).tolist()
        found[kind] = sums
print("SEEN " + json.dumps(found), flush=True)
os._exit(0)
"""


@pytest.fixture
def stages(tmp_path):
    """Three hundred particles of two sources in a cube, one of them far off, and two balls of foam; in frame 1, after
    a frame 0 without any."""
    simulation, foam = tmp_path / "simulation", tmp_path / "foam"
    for folder in (simulation, foam):
        folder.mkdir()
    random = np.random.default_rng(1)
    points = np.zeros(300, FLUID_POINT)
    for axis in "xyz":
        points[axis] = random.uniform(-0.1, 0.2, len(points))
        points[f"v{axis}"] = random.uniform(-2, 2, len(points))
    points["x"][7], points["id"] = 50.0, np.arange(len(points))
    balls = np.zeros(2, FOAM_POINT)
    balls["x"], balls["radius"] = [0.3, 0.4], [0.002, 0.003]
    for frame, (some, few) in enumerate(((points[:0], balls[:0]), (points, balls))):
        write_points(simulation / f"fluid_{frame:05d}.ply", some)
        write_points(foam / f"foam_{frame:05d}.ply", few)
    (simulation / "sources.csv").write_text("id,time,source\n0,0,tank\n100,0.04,tap\n")
    return simulation, foam, points, balls


def export(stages, path, *more):
    command = [sys.executable, "-m", "render", "--spec", "{}", "--frames", "0:1", "--fps", str(FPS)]
    command += ["--simulation", str(stages[0]), "--foam", str(stages[1]), "--out", str(path.parent / "out")]
    return subprocess.run(
        [*command, "--export", str(path), *more], capture_output=True, text=True, timeout=120, cwd=ROOT
    )


def look(tmp_path, path):
    script = tmp_path / "look.py"
    script.write_text(f"import sys; sys.path.insert(0, {str(ROOT)!r})\n{LOOK}")
    looked = subprocess.run([sys.executable, str(script), str(path)], capture_output=True, text=True, timeout=120)
    line = next((line for line in looked.stdout.splitlines() if line.startswith("SEEN ")), None)
    assert line is not None, looked.stdout + looked.stderr
    return json.loads(line.removeprefix("SEEN "))


@pytest.mark.parametrize("voxel", [None, 0.013])
def test_sums_over_cells_are_those_over_particles(stages, tmp_path, voxel):
    """Of volumes, of their moments, and of velocities, ages and shares times volumes, whatever the cells; one particle
    far off costs eight cells."""
    _, _, points, balls = stages
    done = export(stages, tmp_path / "w.vdb", "--particles", str(RADIUS), *(["--voxel", str(voxel)] if voxel else []))
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.glob("*.vdb")) == ["w_00000.vdb", "w_00001.vdb"]
    found = look(tmp_path, tmp_path / "w_00001.vdb")
    assert found["blender"] == ["age", "density", "foam", "source_tank", "source_tap", "velocity"]
    volume, seen = 8 * RADIUS**3, found["density"]
    place, speed = (np.stack([points[f"{kind}{axis}"] for axis in "xyz"], axis=1, dtype=float) for kind in ("", "v"))
    assert seen["volume"] == pytest.approx(len(points) * volume, rel=1e-5)
    assert seen["moment"] == pytest.approx(volume * place.sum(axis=0), rel=1e-5)
    assert seen["velocity"] == pytest.approx(volume * speed.sum(axis=0), abs=1e-5 * volume * 300)
    assert seen["age"] == pytest.approx(volume * (100 * 0.1 + 200 * 0.06), rel=1e-5)
    assert [seen["source_tank"], seen["source_tap"]] == pytest.approx([100 * volume, 200 * volume], rel=1e-5)
    assert seen["cells"] < 8 * len(points)
    ball = 4 / 3 * math.pi * balls["radius"].astype(float) ** 3
    assert found["foam"]["volume"] == pytest.approx(ball.sum(), rel=1e-5)
    assert found["foam"]["moment"] == pytest.approx([ball @ balls["x"], 0, 0], rel=1e-5, abs=1e-12)


def test_a_lattice_fills_space(stages, tmp_path):
    """Away from its surface the density of particles a spacing apart is 1: those of a simulation at its start."""
    simulation, foam, *_ = stages
    grid = np.stack(np.meshgrid(*[np.arange(8)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + 0.3
    points = np.zeros(len(grid), FLUID_POINT)
    for axis, name in enumerate("xyz"):
        points[name] = 2 * RADIUS * grid[:, axis]
    points["id"] = np.arange(len(grid))
    write_points(simulation / "fluid_00001.ply", points)
    (simulation / "sources.csv").unlink()
    assert export((simulation, foam), tmp_path / "w.vdb", "--particles", str(RADIUS)).returncode == 0
    found = look(tmp_path, tmp_path / "w_00001.vdb")
    assert found["blender"] == ["density", "foam", "velocity"]
    # 7 full cells along each edge, and 2 in part
    assert found["density"]["cells"] == 9**3
    assert found["density"]["volume"] == pytest.approx(8**3 * 8 * RADIUS**3, rel=1e-5)


def test_an_empty_frame_has_empty_grids(stages, tmp_path):
    assert export(stages, tmp_path / "w.vdb", "--particles", str(RADIUS)).returncode == 0
    found = look(tmp_path, tmp_path / "w_00000.vdb")
    assert "density" in found["blender"] and found["density"]["cells"] == 0


def test_what_cannot_be_written_leaves_no_file(stages, tmp_path):
    done = export(stages, tmp_path / "w.vdb")
    assert done.returncode == 2 and "give --particles" in done.stderr
    last = stages[0] / "fluid_00001.ply"
    last.write_bytes(last.read_bytes()[:-20])
    done = export(stages, tmp_path / "w.vdb", "--particles", str(RADIUS))
    assert done.returncode == 2 and "fluid_00001.ply" in done.stderr
    assert not [path for path in tmp_path.iterdir() if "vdb" in path.name]
