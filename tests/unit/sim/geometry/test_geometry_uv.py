"""Places in textures and materials survive what happens to a mesh on its way to a body."""

from __future__ import annotations

import numpy as np
import pytest

from sim.geometry.meshes.formats import read
from sim.geometry.shapes import load_mesh
from sim.geometry.spec import MeshFile
from sim.geometry.triangles import MATERIAL, UV, vertex_colors
from tests.support import textured


@pytest.fixture(autouse=True)
def _files(tmp_path, monkeypatch):
    monkeypatch.setenv("TIDEMILL_CACHE", str(tmp_path / "cache"))
    textured.write(tmp_path)


def expected(corners: np.ndarray) -> np.ndarray:
    """UV of triangles on the sides of the cube, shape [m, 3, 3], by where they are."""
    found = np.empty((*corners.shape[:2], 2))
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for index, (triangle, out) in enumerate(zip(corners, normal, strict=True)):
        for start, right, up in textured._SIDES:
            if np.cross(right, up) @ out > 0.9 * np.linalg.norm(out):
                found[index] = (triangle - np.array(start) / 2) @ np.array([right, up]).T
    return found


@pytest.mark.parametrize("name", ["cube.obj", "plain.obj", "cube.glb", "cube.ply"])
def test_a_closed_mesh_keeps_them(tmp_path, name):
    mesh, _ = load_mesh(MeshFile(type="mesh", file=name), tmp_path / name)
    corners = mesh.vertices[mesh.faces]
    assert len(mesh.vertices) == 8
    assert mesh.face_attributes[UV] == pytest.approx(expected(corners), abs=1e-6)
    if name in ("cube.obj", "cube.glb"):
        assert not np.any(mesh.face_attributes[MATERIAL])
    else:
        assert MATERIAL not in mesh.face_attributes


def test_so_does_one_that_is_scaled_turned_moved_and_mended(tmp_path):
    """A triangle is missing, others look inward; the rest keeps its own."""
    lines = textured.obj().splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("f "))
    _, *corners = lines[first + 3].split()
    lines[first + 3] = "f " + " ".join(reversed(corners))
    del lines[first + 11]
    (tmp_path / "broken.obj").write_text("\n".join(lines) + "\n")
    shape = MeshFile(type="mesh", file="broken.obj", up="z", size=0.1, anchor="base", close="all")
    mesh, report = load_mesh(shape, tmp_path / "broken.obj")
    assert report.holes == 1 and mesh.bounds[:, 1] == pytest.approx([0, 0.1])
    back = (mesh.vertices[mesh.faces] - mesh.bounds.mean(axis=0)) / 0.1 @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    wanted = expected(back)
    whole = np.abs(back.mean(axis=1)[:, 1] + 0.5) > 1e-6
    assert whole.sum() >= 10
    assert mesh.face_attributes[UV][whole] == pytest.approx(wanted[whole], abs=1e-6)


def test_both_sides_of_a_shell_have_what_the_surface_has(tmp_path):
    mesh, _ = load_mesh(MeshFile(type="mesh", file="cube.obj", thickness=0.02), tmp_path / "cube.obj")
    corners = mesh.vertices[mesh.faces]
    outside = np.abs(np.abs(corners).max(axis=2) - 0.51).max(axis=1) < 1e-9
    assert outside.sum() == 12
    assert mesh.face_attributes[UV][outside] == pytest.approx(np.clip(expected(corners[outside]), 0, 1), abs=1e-6)


def test_materials_are_numbered_as_they_are_named_first(tmp_path):
    lines = textured.obj(head="mtllib cube.mtl\nusemtl b b\n").splitlines()
    lines.insert(len(lines) - 2, "usemtl a")
    (tmp_path / "two.obj").write_text("\n".join(lines) + "\n")
    mesh = read(tmp_path / "two.obj")
    below = (mesh.vertices[mesh.faces][:, :, 1] == -0.5).all(axis=1)
    assert mesh.face_attributes[MATERIAL].tolist() == below.astype(int).tolist()


def test_colours_of_vertices_stay_where_faces_have_materials(tmp_path):
    points, _, triangles = textured.cube()
    lines = ["mtllib cube.mtl", "usemtl paint", *(f"v {x} {y} {z} 1 0 0" for x, y, z in points)]
    lines += [f"f {a} {b} {c}" for a, b, c in triangles + 1]
    (tmp_path / "colored.obj").write_text("\n".join(lines) + "\n")
    mesh = read(tmp_path / "colored.obj")
    assert (vertex_colors(mesh) == [255, 0, 0, 255]).all()
    assert not np.any(mesh.face_attributes[MATERIAL])
