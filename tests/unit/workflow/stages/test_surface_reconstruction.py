"""Particles in, closed surfaces out: volume, closedness, velocity, and files that common tools open."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from common.frames import Frames
from common.ply import BadPly, columns, read_points
from scene.presets import PRESETS, QUALITIES
from tests.support.meshes import open_edges
from workflow.reconstruct import run
from workflow.stages.surface.spec import ReconstructSpec, SurfaceSpec
from workflow.stages.surface.surface import reconstruct

ROOT = Path(__file__).resolve().parents[4]
RADIUS = 0.02
FLUID = np.dtype([(name, "<f4") for name in ("x", "y", "z", "vx", "vy", "vz", "density")] + [("id", "<i4")])


def ball(radius: float = 0.5, centre: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Centres of the cells of a cubic lattice in a ball [m], float32, shape [n, 3]."""
    steps = math.ceil(radius / (2 * RADIUS))
    line = (np.arange(-steps, steps) + 0.5) * 2 * RADIUS
    points = np.stack(np.meshgrid(line, line, line, indexing="ij"), -1).reshape(-1, 3)
    return (points[np.linalg.norm(points, axis=1) < radius] + centre).astype(np.float32)


def write_fluid(path: Path, positions: np.ndarray, velocities: np.ndarray) -> None:
    points = np.zeros(len(positions), FLUID)
    for axis, name in enumerate("xyz"):
        points[name], points[f"v{name}"] = positions[:, axis], velocities[:, axis]
    kinds = {"f4": "float", "i4": "int"}
    header = [f"property {kinds[FLUID[name].str[1:]]} {name}" for name in FLUID.names]
    top = ["ply", "format binary_little_endian 1.0", "comment test", f"element vertex {len(points)}", *header]
    path.write_bytes("\n".join([*top, "end_header\n"]).encode() + points.tobytes())


def spec(**surface) -> ReconstructSpec:
    return ReconstructSpec(particle_radius=RADIUS, surface=SurfaceSpec(**surface))


@pytest.mark.parametrize("quality", QUALITIES)
def test_volume_of_a_ball(quality):
    positions = ball()
    surface = reconstruct(positions, np.zeros_like(positions), spec(**PRESETS[quality]["surface"]))
    assert surface.volume == pytest.approx(4 / 3 * math.pi * 0.5**3, rel=0.035)
    assert open_edges(surface.triangles) == 0
    radii = np.linalg.norm(surface.vertices, axis=1)
    assert np.abs(radii - 0.5).max() < 2 * RADIUS


def test_volume_does_not_depend_on_the_place():
    near, far = ball(), ball(centre=(40.0, -7.0, 13.0))
    volumes = [reconstruct(points, np.zeros_like(points), spec()).volume for points in (near, far)]
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-3)


@pytest.mark.parametrize("source", ["mesh", "particles"])
def test_normals_point_outwards_and_have_unit_length(source):
    positions = ball()
    surface = reconstruct(positions, np.zeros_like(positions), spec(normals={"source": source}))
    outwards = surface.vertices / np.linalg.norm(surface.vertices, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", outwards, surface.normals).min() > 0.8
    assert np.linalg.norm(surface.normals, axis=1) == pytest.approx(1.0, abs=1e-5)


def test_a_constant_velocity_is_carried_exactly():
    positions = ball()
    velocities = np.tile(np.float32([1.0, -2.0, 0.5]), (len(positions), 1))
    surface = reconstruct(positions, velocities, spec())
    assert np.abs(surface.velocities - [1.0, -2.0, 0.5]).max() < 1e-5


@pytest.mark.parametrize("radius", [2.0, 3.0, 4.0])
def test_a_constant_velocity_is_carried_into_a_void(radius):
    """As under a ball that has just dived: coarse cells and smoothing take vertices out of reach of all particles."""
    spacing, velocity = 0.04, np.array([3, -1, 0.5], np.float32)
    indices = np.stack(np.meshgrid(*[np.arange(14) - 6.5] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    positions = (spacing * indices[np.linalg.norm(indices, axis=1) > radius]).astype(np.float32)
    found = reconstruct(
        positions,
        np.tile(velocity, (len(positions), 1)),
        ReconstructSpec(particle_radius=spacing / 2, surface={"cube_size": 1.5}),
    )
    assert np.linalg.norm(found.vertices, axis=1).min() < radius * spacing, "there is no void"
    assert np.allclose(found.velocities, velocity, rtol=1e-5)


def test_a_linear_velocity_is_carried_within_a_kernel_radius():
    positions = ball()
    gradient = np.float32([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    surface = reconstruct(positions, positions @ gradient, spec())
    error = np.abs(surface.velocities - surface.vertices @ gradient)
    assert error.max() < 2 * RADIUS
    middle = np.abs(surface.velocities).max()
    assert middle > 0.4


def test_one_particle_and_particles_far_apart():
    for positions in (np.zeros((1, 3), np.float32), np.float32([[0, 0, 0], [100, 0, 0], [0, 1000, 0]])):
        surface = reconstruct(positions, np.ones_like(positions), spec())
        assert len(surface.triangles) > 0
        assert open_edges(surface.triangles) == 0
        assert np.isfinite(surface.vertices).all()
        assert np.abs(surface.velocities - 1).max() < 1e-5


def test_threads_change_nothing_but_the_order():
    positions = ball()
    results = [reconstruct(positions, positions, spec(), threads=threads) for threads in (1, 2)]
    assert results[0].volume == pytest.approx(results[1].volume, rel=1e-5)
    assert len(results[0].triangles) == len(results[1].triangles)


def test_the_stage_writes_meshes_and_a_summary(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    points = ball(0.2)
    write_fluid(tmp_path / "fluid_00007.ply", points, np.ones_like(points))
    write_fluid(tmp_path / "fluid_00008.ply", points[:0], points[:0])
    run(spec(), tmp_path, Frames(7, 8), tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "done"
    assert {"import", "load", "splashsurf", "write", "total"} <= set(summary["wall_s"])
    full, empty = summary["frames"]
    mesh = trimesh.load_mesh(tmp_path / "out" / "surface_00007.ply", process=False)
    assert mesh.is_watertight
    assert len(mesh.vertices) == full["vertices"]
    assert mesh.volume == pytest.approx(full["volume"], rel=1e-5)
    table = read_points(tmp_path / "out" / "surface_00007.ply")
    assert table.dtype.names == ("x", "y", "z", "nx", "ny", "nz", "vx", "vy", "vz")
    assert np.abs(columns(table, ("vx", "vy", "vz")) - 1).max() < 1e-5
    assert empty == {"frame": 8, "particles": 0, "vertices": 0, "triangles": 0, "volume": 0.0}
    assert len(read_points(tmp_path / "out" / "surface_00008.ply")) == 0
    plyfile = pytest.importorskip("plyfile")
    assert len(plyfile.PlyData.read(tmp_path / "out" / "surface_00008.ply")["face"]) == 0


def stage(folder: Path, **options: str) -> subprocess.CompletedProcess[str]:
    given = {"spec": f'{{"particle_radius": {RADIUS}}}', "simulation": str(folder), "frames": "0:0", **options}
    command = [sys.executable, "-m", "workflow.reconstruct", "--out", str(folder / "out")]
    command += [part for name, value in given.items() for part in (f"--{name}", value)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


def test_what_can_not_be_used_is_refused(tmp_path):
    points = ball(0.1)
    path = tmp_path / "fluid_00000.ply"
    write_fluid(path, points, np.full_like(points, np.nan))
    attempts = [
        (stage(tmp_path), "not finite"),
        (stage(tmp_path, frames="1:1"), "fluid_00001.ply is missing"),
        (stage(tmp_path, spec='{"particle_radius": -1}'), "particle_radius"),
        (stage(tmp_path, spec="missing.json"), "missing.json"),
        (stage(tmp_path, frames="3:1"), "FIRST:LAST"),
    ]
    path.write_bytes(path.read_bytes()[:-5])
    attempts.append((stage(tmp_path), "cut off"))
    path.write_bytes(b"solid stl")
    attempts.append((stage(tmp_path), "not a binary little-endian PLY"))
    for done, words in attempts:
        assert done.returncode == 2, done.stderr
        assert words in done.stderr
        assert "Traceback" not in done.stderr
    assert not list((tmp_path / "out").glob("*.ply"))


def test_a_table_without_velocity(tmp_path):
    path = tmp_path / "a.ply"
    path.write_bytes(b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nend_header\n\0\0\0\0")
    with pytest.raises(BadPly, match="no property vx"):
        columns(read_points(path), ("x", "vx"))


def test_normals_are_finite_where_triangles_have_no_area():
    from workflow.stages.surface.surface import _finite

    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [5, 5, 5]], np.float32)
    triangles = np.array([[0, 1, 2], [0, 3, 3], [4, 4, 4]], np.int32)
    normals = np.full((5, 3), np.nan, np.float32)
    normals[1] = [0, 0, 1]
    expected = [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 1, 0]]
    np.testing.assert_allclose(_finite(normals, vertices, triangles), expected, atol=1e-6)
