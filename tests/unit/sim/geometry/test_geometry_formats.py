"""Which files are read, and what is said of those that are not."""

import json
import zipfile

import numpy as np
import pytest
import trimesh

from scene.settings import Refused
from sim.geometry.meshes.formats import FORMATS, read
from sim.geometry.shapes import load_mesh
from sim.geometry.spec import MeshFile


def load(path):
    return load_mesh(MeshFile(type="mesh", file=path.name), path)[0]


@pytest.mark.parametrize("kind", [kind for kind in FORMATS if kind not in (".gltf", ".3mf")])
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


# Moved by 200 along x and turned, x to y.
ITEMS = '<item objectid="1"/><item objectid="1" transform="0 1 0 -1 0 0 0 0 1 200 0 0"/>'


def model(unit="", items=ITEMS, objects=""):
    """The model of a 3MF, whose object 1 is a box of 100 x 50 x 20."""
    box = trimesh.creation.box((100, 50, 20))
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in box.vertices)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in box.faces)
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
    return (
        f'<?xml version="1.0"?><model {unit} xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f'<resources><object id="1" type="model">{mesh}</object>{objects}</resources><build>{items}</build></model>'
    )


def archive(path, content, name="3D/3dmodel.model"):
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("[Content_Types].xml", "<Types/>")
        file.writestr(name, content)
    return path


@pytest.mark.parametrize(
    ("unit", "metre"),
    [("", 1e-3), ('unit="millimeter"', 1e-3), ('unit="inch"', 0.0254), ('unit="centimeter"', 1e-2)],
)
def test_a_3mf_is_built_in_its_unit(tmp_path, unit, metre):
    mesh = load(archive(tmp_path / "part.3mf", model(unit)))
    np.testing.assert_allclose(mesh.bounds, metre * np.array([[-50, -50, -10], [225, 50, 10]]), rtol=1e-14)
    assert mesh.volume == pytest.approx(metre**3 * 2 * 100_000)


def test_objects_of_a_3mf_are_made_of_others(tmp_path):
    """Only what is built is there: object 2, of two boxes 300 mm apart, and not object 1 by itself."""
    parts = '<component objectid="1"/><component objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 300"/>'
    pair = f'<object id="2"><components>{parts}</components></object>'
    item = '<item objectid="2" transform="1 0 0 0 1 0 0 0 1 1000 0 0"/>'
    mesh = load(archive(tmp_path / "part.3mf", model(items=item, objects=pair)))
    np.testing.assert_allclose(mesh.bounds, [[0.95, -0.025, -0.01], [1.05, 0.025, 0.31]], rtol=1e-12)
    assert mesh.volume == pytest.approx(2e-4)


def test_size_stands_above_the_unit_of_a_3mf(tmp_path):
    path = archive(tmp_path / "part.3mf", model('unit="inch"'))
    mesh, _ = load_mesh(MeshFile(type="mesh", file=path.name, size=0.55), path)
    np.testing.assert_allclose(np.ptp(mesh.bounds, axis=0), [0.55, 0.2, 0.04], rtol=1e-12)


@pytest.mark.parametrize(
    ("content", "name", "says"),
    [
        (model(), "3D/other.xml", "holds no model"),
        (model(items=""), "3D/3dmodel.model", "holds no model"),
        (model(items='<item objectid="7"/>'), "3D/3dmodel.model", "has no faces"),
        (model()[:-60], "3D/3dmodel.model", "cannot be read as a triangle mesh"),
        (model('unit="cubit"'), "3D/3dmodel.model", "is in the unit 'cubit'"),
    ],
    ids=["no model", "nothing built", "an object that is not there", "cut off", "no such unit"],
)
def test_a_broken_3mf_is_refused(tmp_path, content, name, says):
    with pytest.raises(Refused, match=says) as refused:
        load(archive(tmp_path / "part.3mf", content, name))
    assert "part.3mf" in refused.value.message
    assert refused.value.remedy


def test_a_3mf_that_is_no_archive_is_refused(tmp_path):
    (tmp_path / "part.3mf").write_bytes(b"PK\x03\x04")
    with pytest.raises(Refused, match=r"'part.3mf' cannot be read as a triangle mesh \(BadZipFile"):
        read(tmp_path / "part.3mf")


@pytest.mark.parametrize(
    ("name", "says", "remedy"),
    [
        ("part.FBX", "is FBX", "OBJ, STL or PLY"),
        ("part.blend", "is a file of Blender", "OBJ, STL or PLY"),
        ("part.step", "holds curved surfaces", "OBJ, STL or PLY from the CAD program"),
        ("part.STP", "holds curved surfaces", "OBJ, STL or PLY from the CAD program"),
        ("part.igs", "holds curved surfaces", "OBJ, STL or PLY from the CAD program"),
        ("part.zip", "in no format that is read", "OBJ, STL, PLY, OFF, GLB, glTF, 3MF"),
        ("part.dxf", "in no format that is read", "OBJ, STL, PLY, OFF, GLB, glTF, 3MF"),
        ("part", "in no format that is read", "OBJ, STL, PLY, OFF, GLB, glTF, 3MF"),
    ],
)
def test_other_formats_are_refused_with_a_remedy(tmp_path, name, says, remedy):
    (tmp_path / name).write_bytes(b"PK\x03\x04")
    with pytest.raises(Refused, match=says) as refused:
        read(tmp_path / name)
    assert name in refused.value.message
    assert remedy in refused.value.remedy
