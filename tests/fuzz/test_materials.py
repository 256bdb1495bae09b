"""Materials of mesh files, and their images, that are broken."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import pytest
from hypothesis import given

from common.imported import gltf
from common.imported.image_files import cut_off, too_large
from scene.imported.bodies import found_in
from scene.settings import Refused
from sim.geometry.meshes.formats import read
from sim.geometry.spec import MeshFile
from sim.rigid.spec import RigidBody
from tests.fuzz.mutations import broken, broken_bytes, fuzzed
from tests.support import textured

MTL = (
    "newmtl paint\nKd 1 0.5 0\nKs 0 0 0\nNs 10\nd 0.5\nPr 0.5\nNi 1.5\n"
    "map_Kd -s 1 1 1 -clamp on quarters.png\nnorm quarters.png\n"
)
PIECES = (b"nan", b"inf", b"-1", b"1e300", b"../", b"~/", b"file:///", b"map_Kd", b"newmtl", b"\0", b"\xff", b"\n")


@pytest.fixture
def survives(tmp_path, survived):
    """Reads what a body of a file brings; anything but materials or Refused fails the test."""
    textured.write(tmp_path)

    def check(name: str) -> None:
        body = RigidBody(shape=MeshFile(type="mesh", file=name))
        with survived(Refused):
            found_in(body, tmp_path, ())

    return check


def test_libraries(tmp_path: Path, survives):
    @fuzzed(60)
    @given(broken_bytes(MTL.encode(), PIECES))
    def check(changed):
        (tmp_path / "cube.mtl").write_bytes(changed)
        survives("cube.obj")

    check()


def test_names_of_libraries(tmp_path: Path, survives):
    @fuzzed(60)
    @given(broken_bytes(b"mtllib cube.mtl\nusemtl paint\n", PIECES))
    def check(changed):
        (tmp_path / "cube.obj").write_bytes(changed + textured.obj("").encode())
        survives("cube.obj")

    check()


def whole() -> dict:
    """What a glTF says of materials in all ways that are understood."""
    surface = {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0, "texCoord": 0}}
    moved = {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1.0, "scale": [2, 2]}}
    said = {
        "pbrMetallicRoughness": surface | {"baseColorFactor": [1, 1, 1, 0.5]},
        "normalTexture": {"index": 0, "scale": 0.5, "extensions": moved},
        "emissiveFactor": [1, 0, 0],
        "alphaMode": "MASK",
        "extensions": {"KHR_materials_ior": {"ior": 1.4}},
    }
    head, rest = gltf.parted(textured.glb(material=said, samplers=[{"wrapS": 33071}]))
    head["textures"][0]["sampler"] = 0
    head["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(rest[8:]).decode()
    return head


def test_heads_of_gltf(tmp_path: Path, survives, survived):
    @fuzzed(150)
    @given(broken(whole()))
    def check(changed):
        (tmp_path / "cube.gltf").write_text(json.dumps(changed))
        survives("cube.gltf")
        with survived(Refused):
            read(tmp_path / "cube.gltf")
        with survived(ValueError):
            gltf.image(*gltf.parted((tmp_path / "cube.gltf").read_bytes()), 0)

    check()


def test_a_head_that_is_nested_without_end(tmp_path: Path):
    (tmp_path / "cube.gltf").write_text('{"materials":' + "[" * 100_000)
    with pytest.raises(ValueError, match="nested"):
        gltf.parted((tmp_path / "cube.gltf").read_bytes())
    with pytest.raises(Refused, match="cannot be read"):
        read(tmp_path / "cube.gltf")


def test_a_number_beyond_all_numbers(tmp_path: Path):
    head = whole()
    head["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"]["rotation"] = 10**400
    (tmp_path / "cube.gltf").write_text(json.dumps(head))
    with pytest.raises(Refused, match="cannot be read"):
        found_in(RigidBody(shape=MeshFile(type="mesh", file="cube.gltf")), tmp_path, ())


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "TIFF"])
def test_heads_of_images(kind, survived):
    @fuzzed(60)
    @given(broken_bytes(textured.picture(kind)))
    def check(changed):
        with survived():
            cut_off(changed)
            too_large(changed)

    check()
