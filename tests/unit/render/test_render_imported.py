"""Materials of mesh files as Blender's: each face has its own, and each image is read as what it is."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from render.blender import versions
from render.content.bodies import Body
from render.content.materials import default_body_look, make_materials
from render.content.ply import TriangleMesh
from render.content.scene import plain
from render.errors import Unusable
from render.texturing.nodes import places
from render.texturing.spec import Imported, ImportedImage, ImportedMaterial
from tests.support import textured


@pytest.fixture(autouse=True)
def _empty(tmp_path, monkeypatch):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    monkeypatch.chdir(tmp_path)
    textured.write(tmp_path)


def made(*materials):
    look = plain(Imported(type="imported", materials=materials).model_dump(mode="json"))
    return look, make_materials("cube", look, 1.0, False, default_body_look(0))


def source(material=None):
    points, uv, triangles = textured.cube()
    columns = {name: np.ascontiguousarray(column, np.float32) for name, column in zip("xyz", points.T, strict=True)}
    return TriangleMesh(columns, triangles.astype(np.int32).ravel(), uv[triangles].astype(np.float32).ravel(), material)


def shader(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def leading_to(material, name):
    """All nodes on which an input depends."""
    found, wanted = [], [versions.input_named(shader(material), name)]
    while wanted:
        for link in wanted.pop().links:
            found.append(link.from_node)
            wanted += link.from_node.inputs
    return found


def test_faces_have_their_own_and_others_the_usual():
    look, materials = made(ImportedMaterial(name="a", base=(1, 0, 0)), ImportedMaterial(name="b", base=(0, 1, 0)))
    assert [material.name for material in materials] == ["cube a", "cube b", "cube"]
    numbers = np.array([0, 1, -1, 7] + 8 * [1], np.int32)
    body = Body("cube", source(numbers), *materials, uv=places("cube", source(), look))
    assert [slot.material.name for slot in body.thing.material_slots] == ["cube a", "cube b", "cube"]
    assert [face.material_index for face in body.thing.data.polygons][:5] == [0, 1, 2, 2, 1]
    assert tuple(versions.input_named(shader(materials[1]), "Base Color").default_value) == (0, 1, 0, 1)


def test_uv_are_those_of_the_file():
    _, materials = made(ImportedMaterial())
    body = Body("cube", source(), *materials, uv=source().uv)
    _, uv, triangles = textured.cube()
    layer = body.thing.data.uv_layers["UVMap"]
    assert np.array([list(place.uv) for place in layer.data]) == pytest.approx(uv[triangles].reshape(-1, 2))


def test_colours_are_colours_and_numbers_are_numbers():
    within = ImportedImage(file="cube.glb", image=0)
    gloss = within.model_copy(update={"channel": "green"})
    _, (paint, _) = made(
        ImportedMaterial(base=(0.5, 0.5, 0.5), base_map=within, roughness_map=gloss, normal_map=within, normal_scale=2)
    )
    spaces = {}
    for name in ("Base Color", "Roughness", "Normal"):
        nodes = leading_to(paint, name)
        [image] = [node.image for node in nodes if node.type == "TEX_IMAGE"]
        spaces[name] = image.colorspace_settings.name
        assert image.packed_file is not None and tuple(image.size) == (16, 16)
    assert spaces == {"Base Color": "sRGB", "Roughness": "Non-Color", "Normal": "Non-Color"}
    assert [node.inputs["Strength"].default_value for node in leading_to(paint, "Normal") if node.type == "NORMAL_MAP"]


def test_an_image_is_loaded_once():
    image = ImportedImage(file="quarters.png")
    made(ImportedMaterial(base_map=image), ImportedMaterial(base_map=image, alpha_map=image))
    assert len([image for image in bpy.data.images if image.source == "FILE"]) == 1


@pytest.mark.parametrize(
    ("cutoff", "alpha", "expected"), [(None, 0.25, 0.25), (0.5, 0.25, 0.0), (0.5, 0.5, 1.0), (None, 1.0, 1.0)]
)
def test_opacity(cutoff, alpha, expected):
    _, (glass, _) = made(ImportedMaterial(alpha=alpha, cutoff=cutoff))
    assert versions.input_named(shader(glass), "Alpha").default_value == expected


@pytest.mark.parametrize("file", ["gone.png", "cube.mtl"])
def test_an_image_that_is_none_is_refused(file):
    look = SimpleNamespace(type="plastic", texture=file, projection=None, texture_size=None)
    with pytest.raises(Unusable, match=r"materials\.cube\.texture: .*" + file):
        places("cube", source(), look)
