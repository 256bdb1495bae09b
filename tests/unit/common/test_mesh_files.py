"""Meshes that a run writes."""

import bpy
import numpy as np
import pytest
import trimesh

from common.ply import read_mesh, write_mesh
from render.content import ply
from render.errors import Unusable

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]])
FACES = np.array([[0, 1, 2]])
COLORS = np.array([[255, 0, 0, 255], [0, 128, 0, 255], [1, 2, 3, 255]], dtype=np.uint8)


@pytest.mark.parametrize(("colors", "vertex_size"), [(None, 12), (COLORS, 15)], ids=["plain", "coloured"])
def test_what_is_written_can_be_read(tmp_path, colors, vertex_size):
    path = tmp_path / "body.ply"
    write_mesh(path, VERTICES, FACES, colors)
    content = path.read_bytes()
    assert len(content.partition(b"end_header\n")[2]) == 3 * vertex_size + 13
    assert (b"property uchar red" in content) == (colors is not None)
    mesh = trimesh.load_mesh(path, process=False)
    assert (mesh.vertices == VERTICES).all()
    assert (mesh.faces == FACES).all()
    if colors is not None:
        assert (mesh.visual.vertex_colors == colors).all()


def test_more_numbers_of_vertices_keep_their_names(tmp_path):
    path = tmp_path / "cloth.ply"
    write_mesh(
        path, VERTICES, FACES, velocities=-VERTICES, more={"thickness": np.array([1, 2, 3]), "rest_x": np.ones(3)}
    )
    points, faces = read_mesh(path)
    assert points.dtype.names == ("x", "y", "z", "vx", "vy", "vz", "thickness", "rest_x")
    assert points["thickness"].tolist() == [1, 2, 3]
    assert points["vz"].tolist() == [0, 0, -0.5]
    assert (faces == FACES).all()


UV = np.array([[[0, 0], [1, 0], [0.25, 0.5]]])


def test_places_in_textures_are_those_of_other_programs(tmp_path):
    """Of MeshLab, whose names trimesh reads; Blender's reader leaves them out."""
    path = tmp_path / "body.ply"
    write_mesh(path, VERTICES, FACES, COLORS, uv=UV, material=np.array([2]), comments=["turned"])
    found = trimesh.load_mesh(path, process=False)
    assert found.visual.uv[found.faces] == pytest.approx(UV)
    assert found.vertices[found.faces] == pytest.approx(VERTICES[FACES])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert bpy.ops.wm.ply_import(filepath=str(path)) == {"FINISHED"}
    assert len(bpy.data.meshes["body"].polygons) == 1


@pytest.mark.parametrize("numpy", [True, False])
def test_the_render_stage_reads_them(tmp_path, monkeypatch, numpy):
    path = tmp_path / "body.ply"
    turned = "turned 0 -1 0 1 0 0 0 0 1"
    write_mesh(path, VERTICES, FACES, uv=UV, material=np.array([2]), comments=[turned])
    monkeypatch.setattr(ply, "np", np if numpy else None)
    mesh = ply.read_mesh(path)
    assert list(mesh.triangles) == [0, 1, 2]
    assert list(mesh.uv) == UV.ravel().tolist() and list(mesh.material) == [2]
    assert mesh.turned == (0, -1, 0, 1, 0, 0, 0, 0, 1)
    write_mesh(path, VERTICES, FACES, uv=np.full((1, 3, 2), np.nan))
    with pytest.raises(Unusable, match="place in a texture"):
        ply.read_mesh(path)
