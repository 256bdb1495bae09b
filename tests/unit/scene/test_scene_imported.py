"""Materials that mesh files bring: what is read of them, what is told, and what is refused."""

from __future__ import annotations

import base64
import io
import json
import math
from pathlib import Path

import pytest
from PIL import Image

from common.imported import gltf
from scene.imported.bodies import found_in
from scene.load import load
from sim.spec import SimulationSpec
from tests.support import textured

CRATE = "    crate: {shape: {type: mesh, file: FILE}, position: [0, 2, 0]}"


@pytest.fixture
def crate(bench, scene):
    """The text of a scene with a body of a file, beside which all files of the cube are."""
    textured.write(bench.folder)
    return lambda file, more="": scene(more=CRATE.replace("FILE", file) + (f"\n{more}" if more else ""))


@pytest.fixture
def materials(bench, crate):
    """The materials that the crate gets."""

    def read(file: str, more: str = ""):
        return load(bench.write(crate(file, more))).render.materials["crate"].materials

    return read


@pytest.mark.parametrize(("file", "name", "number"), [("cube.obj", "quarters.png", None), ("cube.glb", "cube.glb", 0)])
def test_a_file_brings_its_own(materials, file, name, number):
    [paint] = materials(file)
    assert (paint.name, paint.base, paint.base_map.file, paint.base_map.image) == ("paint", (1, 1, 1), name, number)


def test_files_without_any_bring_none(bench, crate):
    assert load(bench.write(crate("plain.obj"))).render.materials == {}


def test_what_mtl_says(bench, materials):
    """Names hold blanks, and the exponent 250 of a highlight is half of what Blender takes for a mirror's."""
    (bench.folder / "cube.mtl").write_text(
        "# made by hand\nnewmtl other\nKd 1 0 0\n\nnewmtl paint\nKa 1 1 1\nKd 0.2 0.4 0.6\nKs 0.3 0.3 0.3\nNs 250\n"
        "Ni 1.4\nd 0.5\nKe 0 0 2\nillum 2\nPm 0.25\nPc 0.75\nPcr 0.125\n"
        "map_Ke -s 2 3 1 -o 0.5 -clamp on quarters.png\nnorm quarters.png\nmap_d quarters.png\n"
    )
    [paint] = materials("cube.obj")
    assert (paint.base, paint.specular, paint.roughness, paint.ior) == ((0.2, 0.4, 0.6), pytest.approx(0.3), 0.5, 1.4)
    assert (paint.alpha, paint.metallic, paint.coat, paint.coat_roughness) == (0.5, 0.25, 0.75, 0.125)
    lamp = paint.emission_map
    assert (paint.emission, lamp.scale, lamp.offset, lamp.wrap) == ((1, 1, 1), (2, 3), (0.5, 0), "extend")
    assert paint.normal_map.file == "quarters.png" and paint.alpha_map.channel == "red"


def test_roughness_says_more_than_a_highlight(bench, materials):
    (bench.folder / "cube.mtl").write_text("newmtl paint\nNs 250\nPr 0.9\n")
    assert materials("cube.obj")[0].roughness == 0.9
    (bench.folder / "cube.mtl").write_text("newmtl paint\nmap_Pr quarters.png\nPr 0.9\nNs 250\n")
    assert materials("cube.obj")[0].roughness == 1


def test_what_gltf_says(bench, materials):
    said = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4],
            "metallicFactor": 0.5,
            "metallicRoughnessTexture": {"index": 0},
        },
        "normalTexture": {"index": 0, "scale": 0.5},
        "emissiveFactor": [1, 0, 0],
        "alphaMode": "MASK",
        "alphaCutoff": 0.25,
        "extensions": {
            "KHR_materials_ior": {"ior": 1.45},
            "KHR_materials_emissive_strength": {"emissiveStrength": 7},
            "KHR_materials_transmission": {"transmissionFactor": 0.9},
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.6, "clearcoatRoughnessFactor": 0.2},
        },
    }
    (bench.folder / "cube.glb").write_bytes(textured.glb(material=said))
    [paint] = materials("cube.glb")
    assert (paint.base, paint.alpha, paint.cutoff, paint.metallic) == ((0.1, 0.2, 0.3), 0.4, 0.25, 0.5)
    assert (paint.roughness, paint.roughness_map.channel, paint.metallic_map.channel) == (1, "green", "blue")
    assert (paint.normal_scale, paint.emission, paint.emission_strength) == (0.5, (1, 0, 0), 7)
    assert (paint.ior, paint.transmission, paint.coat, paint.coat_roughness) == (1.45, 0.9, 0.6, 0.2)


@pytest.mark.parametrize("place", [(0, 0), (1, 0), (0.25, 0.75)])
def test_an_image_of_a_gltf_is_moved_as_it_says(bench, materials, place):
    """By KHR_texture_transform: scaled, turned, moved, with v downwards; here v is upwards."""
    (x, y), turn, (a, b) = (0.3, -0.2), 0.5, (2, 3)
    moved = {"KHR_texture_transform": {"offset": [x, y], "rotation": turn, "scale": [a, b]}}
    said = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": moved}}}
    (bench.folder / "cube.glb").write_bytes(textured.glb(material=said))
    image = materials("cube.glb")[0].base_map
    (u, v), cosine, sine = place, math.cos(turn), math.sin(turn)
    wanted = (cosine * a * u + sine * b * v + x, 1 - (-sine * a * u + cosine * b * v + y))
    u, v = image.scale[0] * u, image.scale[1] * (1 - v)
    cosine, sine = math.cos(math.radians(image.rotation)), math.sin(math.radians(image.rotation))
    found = (cosine * u - sine * v + image.offset[0], sine * u + cosine * v + image.offset[1])
    assert found == pytest.approx(wanted)


def test_images_of_a_gltf_are_files_or_within(bench, materials):
    head, rest = gltf.parted(textured.glb())
    head["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(rest[8:]).decode()
    (bench.folder / "within.gltf").write_text(json.dumps(head))
    assert materials("within.gltf")[0].base_map.image == 0
    (bench.folder / "my quarters.png").write_bytes(textured.picture())
    (bench.folder / "beside.gltf").write_text(json.dumps(head | {"images": [{"uri": "my%20quarters.png"}]}))
    found = materials("beside.gltf")[0].base_map
    assert (found.file, found.image) == ("my quarters.png", None)


def test_names_are_those_beside_the_file_that_has_them(bench, materials):
    for folder in ("meshes", "library", "pictures"):
        (bench.folder / folder).mkdir()
    (bench.folder / "meshes" / "cube.obj").write_text(textured.obj("mtllib ../library/cube.mtl\nusemtl paint\n"))
    (bench.folder / "library" / "cube.mtl").write_text("newmtl paint\nmap_Kd ..\\pictures\\my quarters.png\n")
    (bench.folder / "pictures" / "my quarters.png").write_bytes(textured.picture())
    assert materials("meshes/cube.obj")[0].base_map.file == "pictures/my quarters.png"


def test_another_look_needs_none_of_it(bench, crate):
    (bench.folder / "cube.mtl").unlink()
    assert "warning" not in bench.accepts(crate("cube.obj", "render: {materials: {crate: {type: metal}}}"))


def test_a_body_that_comes_later_has_them_too(bench, scene):
    textured.write(bench.folder)
    more = "events: [{at: 0.1, add: {rigid: {crate: {shape: {type: mesh, file: cube.obj}, position: [0, 2, 0]}}}}]"
    bench.accepts(scene(more=more))
    assert load(bench.path).render.materials["crate"].materials[0].name == "paint"


def test_uv_of_a_body_that_comes_later(bench, scene):
    textured.write(bench.folder)
    more = "events: [{at: 0.1, add: {rigid: {crate: {shape: SHAPE, position: [0, 2, 0]}}}}]\n"
    more += "render: {materials: {crate: {type: matte, texture: quarters.png, projection: uv}}}"
    bench.accepts(scene(more=more.replace("SHAPE", "{type: mesh, file: plain.obj}")))
    refused = "crate.projection: the mesh of 'crate' has no UV coordinates"
    bench.refuses(scene(more=more.replace("SHAPE", "{type: sphere, radius: 0.1}")), refused)


def test_imported_asks_for_what_there_is(bench, crate):
    more = "render: {materials: {crate: {type: imported}}}"
    bench.accepts(crate("cube.obj", more))
    bench.refuses(crate("plain.obj", more), "render.materials.crate: the shape of 'crate' is no mesh file", at=more)


MISSING = {
    "library": ("cube.mtl", "asset 'cube.mtl' does not exist"),
    "picture": ("quarters.png", "asset 'quarters.png' does not exist"),
}


@pytest.mark.parametrize("case", MISSING)
def test_what_is_missing(bench, crate, case):
    name, said = MISSING[case]
    text = crate("cube.obj")
    bench.accepts(text)
    (bench.folder / name).unlink()
    found = bench.refuses(text, "rigid.bodies.crate.shape.file: ", said, at="cube.obj")
    assert "r give the body a look of its own in render.materials" in found


def test_a_library_that_is_damaged(bench, crate):
    for content, said in (("newmtl paint\nKd red\n", "line 2 of 'cube.mtl' says nothing: 'Kd red'"), ("\0", "no text")):
        (bench.folder / "cube.mtl").write_text(content)
        bench.refuses(crate("cube.obj"), "rigid.bodies.crate.shape.file", said, at="cube.obj")


def large() -> bytes:
    stream = io.BytesIO()
    Image.new("1", (20_000, 20_000)).save(stream, "PNG")
    return stream.getvalue()


BROKEN = {
    "a picture that is cut off": ("cube.obj", "quarters.png", lambda: textured.picture()[:60]),
    "a photograph that is cut off": ("photo.obj", "photo.jpg", lambda: textured.picture("JPEG")[:-30]),
    "a picture that is too large": ("cube.obj", "quarters.png", large),
    "a picture that is none": ("cube.obj", "quarters.png", lambda: b"no picture"),
    "a picture within a GLB that is cut off": ("cube.glb", "cube.glb", lambda: textured.glb(textured.picture()[:60])),
    "something else within a GLB": ("cube.glb", "cube.glb", lambda: textured.glb(b"#EXTM3U\nhttp://127.0.0.1:9/\n")),
}


@pytest.mark.parametrize("case", BROKEN)
def test_pictures_that_cannot_be_read(bench, crate, case):
    file, name, content = BROKEN[case]
    (bench.folder / "photo.obj").write_text(textured.obj("mtllib photo.mtl\nusemtl paint\n"))
    (bench.folder / "photo.mtl").write_text("newmtl paint\nmap_Kd photo.jpg\n")
    (bench.folder / name).write_bytes(content())
    bench.refuses(crate(file), "rigid.bodies.crate.shape.file: ", "Blender cannot read", at=file)


@pytest.mark.parametrize("setting", ["texture", "roughness_map", "normal_map"])
def test_pictures_of_looks(bench, crate, setting):
    look = f"render: {{materials: {{crate: {{type: plastic, {setting}: quarters.png}}}}}}"
    bench.accepts(crate("cube.obj", look))
    (bench.folder / "quarters.png").write_bytes(textured.picture()[:60])
    bench.refuses(crate("cube.obj", look), f"render.materials.crate.{setting}: Blender cannot read", at=look)
    (bench.folder / "quarters.png").unlink()
    bench.refuses(crate("cube.obj", look), f"render.materials.crate.{setting}: asset", "does not exist", at=look)


NO_PLACE = {
    "water": ("water: {type: plastic, texture: quarters.png}", "render.water: no image lies on what flows"),
    "foam": ("foam: {type: imported}", "render.foam: no image lies on what flows"),
    "ground": ("ground: {material: {type: imported}}", "render.ground.material: images lie flat on the ground"),
    "container": ("materials: {tank: {type: matte, texture: quarters.png}}", "tank.texture: 'tank' is a container"),
    "uv of a body without": (
        "materials: {ball: {type: matte, texture: quarters.png, projection: uv}}",
        "ball.projection: the mesh of 'ball' has no UV coordinates",
    ),
    "size of what has none": (
        "materials: {ball: {type: matte, texture: quarters.png, projection: sphere, texture_size: 1}}",
        "projection sphere has no texture_size",
    ),
    "projection of nothing": ("materials: {ball: {type: matte, projection: box}}", "projection is about images"),
    "a film": ("materials: {ball: {type: matte, texture: film.mp4}}", "the file must end in .hdr, .exr, .png"),
}


@pytest.mark.parametrize("case", NO_PLACE)
def test_images_that_can_lie_nowhere(bench, crate, case):
    setting, said = NO_PLACE[case]
    bench.refuses(crate("cube.obj", f"render: {{{setting}}}"), said)


def test_a_sheet_has_no_image(bench, crate):
    more = "cloth: {sheets: {rag: {shape: {type: sheet, size: [1, 1]}, position: [0, 4, 0]}}}\n"
    more += "render: {materials: {rag: {type: plastic, texture: quarters.png}}}"
    bench.refuses(crate("cube.obj", more), "rag.texture: 'rag' is a sheet of cloth: images lie on rigid bodies alone")


LEFT_OUT = {
    "relief": ("cube.obj", "bump -bm 0.2 quarters.png", "relief by heights (bump)"),
    "an option": ("cube.obj", "map_Kd -mm 0 1 quarters.png", "the option -mm of an image"),
    "a material that is not there": ("other.obj", "", "the material 'other', which is not in cube.mtl"),
    "an extension": ("cube.glb", {"extensionsUsed": ["KHR_materials_volume"]}, "the extension KHR_materials_volume"),
    "shadows": ("cube.glb", {"occlusionTexture": {"index": 0}}, "painted shadows (occlusionTexture)"),
}


@pytest.mark.parametrize("case", LEFT_OUT)
def test_what_no_picture_shows_is_told(bench, crate, case):
    file, more, said = LEFT_OUT[case]
    if isinstance(more, str):
        (bench.folder / "cube.mtl").write_text(f"{textured.MTL}{more}\n")
        (bench.folder / "other.obj").write_text(textured.obj("mtllib cube.mtl\nusemtl other\n"))
    else:
        whole, within = (more, None) if "extensionsUsed" in more else ({}, more)
        (bench.folder / "cube.glb").write_bytes(textured.glb(material=within, **whole))
    found = bench.accepts(crate(file))
    assert "rigid.bodies.crate.shape.file: of the materials of 'crate' no picture shows" in found and said in found


def test_images_without_places_are_told(bench, crate):
    text = "\n".join(line for line in textured.obj().splitlines() if not line.startswith("vt"))
    lines = (
        " ".join(part.partition("/")[0] for part in line.split()) if line.startswith("f") else line
        for line in text.splitlines()
    )
    (bench.folder / "bare.obj").write_text("\n".join(lines) + "\n")
    assert "'crate' has images and no UV coordinates" in bench.accepts(crate("bare.obj"))
    assert "warning" not in bench.accepts(crate("cube.obj"))


def test_a_size_that_changes_nothing_is_told(bench, crate):
    look = "render: {materials: {crate: {type: plastic, texture: quarters.png, texture_size: 1}}}"
    assert "crate.texture_size: changes nothing" in bench.accepts(crate("cube.obj", look))
    assert "warning" not in bench.accepts(crate("cube.obj", look.replace("}}}", ", projection: box}}}")))


def test_only_bodies_have_them():
    assert not found_in(SimulationSpec(), Path(), ()).materials


def test_what_is_told_controls_no_terminal(bench, crate):
    (bench.folder / "cube.mtl").write_text(f"{textured.MTL}pa\x1b[31mint 1\n")
    (bench.folder / "cube.glb").write_bytes(textured.glb(extensionsUsed=["KHR_materials_\x1b]0;x\x07"]))
    for file in ("cube.obj", "cube.glb"):
        assert "\x1b" not in bench.accepts(crate(file))
