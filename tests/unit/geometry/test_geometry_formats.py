"""Which files are read, and what is said of those that are not."""

import json

import numpy as np
import pytest
import trimesh

from sim.geometry.formats import FORMATS, read
from sim.geometry.shapes import load_mesh
from sim.geometry.spec import MeshFile
from sim.settings import Refused


def load(path):
    return load_mesh(MeshFile(type="mesh", file=path.name), path)[0]


@pytest.mark.parametrize("kind", [kind for kind in FORMATS if kind != ".gltf"])
@pytest.mark.parametrize("upper", [False, True])
def test_a_box_comes_back_from_each_format(tmp_path, kind, upper):
    path = tmp_path / f"box{kind.upper() if upper else kind}"
    content = trimesh.creation.box((1, 2, 3)).export(file_type=kind[1:])
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    mesh = load(path)
    assert mesh.volume == pytest.approx(6)
    np.testing.assert_allclose(mesh.bounds, [[-0.5, -1, -1.5], [0.5, 1, 1.5]])


def two_boxes():
    """A box of 1 and one of half its size that a node of the scene moves by 3 along x."""
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box())
    scene.add_geometry(
        trimesh.creation.box((0.5, 0.5, 0.5)), transform=trimesh.transformations.translation_matrix([3, 0, 0])
    )
    return scene


def test_objects_of_a_scene_stand_where_it_says(tmp_path):
    path = tmp_path / "two.glb"
    path.write_bytes(two_boxes().export(file_type="glb"))
    mesh = load(path)
    assert mesh.volume == pytest.approx(1.125)
    np.testing.assert_allclose(mesh.bounds, [[-0.5, -0.5, -0.5], [3.25, 0.5, 0.5]])


def test_gltf_is_read_from_one_file_only(tmp_path):
    """What is in another file would change without notice."""
    parts = two_boxes().export(file_type="gltf")
    for name, content in parts.items():
        (tmp_path / name).write_bytes(content)
    with pytest.raises(Refused, match=r"in another file, '.*\.bin'") as refused:
        load(tmp_path / "model.gltf")
    assert "GLB" in refused.value.remedy
    whole = trimesh.exchange.gltf.export_gltf(two_boxes(), embed_buffers=True)
    (tmp_path / "model.gltf").write_bytes(whole["model.gltf"])
    assert all(part["uri"].startswith("data:") for part in json.loads(whole["model.gltf"])["buffers"])
    assert load(tmp_path / "model.gltf").volume == pytest.approx(1.125)


@pytest.mark.parametrize(
    ("name", "says", "remedy"),
    [
        ("part.3mf", "is 3MF", "OBJ, STL or PLY; 3MF is in millimetres"),
        ("part.FBX", "is FBX", "OBJ, STL or PLY"),
        ("part.blend", "is a file of Blender", "OBJ, STL or PLY"),
        ("part.step", "holds curved surfaces", "OBJ, STL or PLY from the CAD program"),
        ("part.STP", "holds curved surfaces", "OBJ, STL or PLY from the CAD program"),
        ("part.igs", "holds curved surfaces", "OBJ, STL or PLY from the CAD program"),
        ("part.zip", "in no format that is read", "OBJ, STL, PLY, OFF, GLB, glTF"),
        ("part.dxf", "in no format that is read", "OBJ, STL, PLY, OFF, GLB, glTF"),
        ("part", "in no format that is read", "OBJ, STL, PLY, OFF, GLB, glTF"),
    ],
)
def test_other_formats_are_refused_with_a_remedy(tmp_path, name, says, remedy):
    (tmp_path / name).write_bytes(b"PK\x03\x04")
    with pytest.raises(Refused, match=says) as refused:
        read(tmp_path / name)
    assert name in refused.value.message
    assert remedy in refused.value.remedy
