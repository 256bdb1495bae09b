"""A scene reads in its own folder, in the folder `scenes` above it, in packages, and where the user allows it."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest
import trimesh

from scene.assets import resolve
from scene.document import SceneError
from tests.support import textured
from workflow.study.load import load_study

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("file", ["../../../private/secret.ply", "~/private/secret.ply", "absolute", "link", "linked"])
def test_no_file_elsewhere(stranger, mesh_shape, file):
    (stranger.folder / "link.ply").symlink_to(stranger.secret)
    (stranger.folder / "models").symlink_to(stranger.secret.parent)
    names = {"absolute": str(stranger.secret), "link": "link.ply", "linked": "models/secret.ply"}
    stranger.write(shape=mesh_shape(names.get(file, file)))
    stranger.refused("scene.yaml:5: rigid.bodies.ball.shape.file", f"leads to {stranger.secret}", "--config allow=")


def test_nor_whether_there_is_one(stranger, mesh_shape):
    answers = []
    for name in ("secret.ply", "absent.ply"):
        stranger.write(shape=mesh_shape(f"~/private/{name}"))
        answers.append(stranger.refused("shape.file").replace(name, "NAME"))
    assert answers[0] == answers[1]


def test_a_refused_scene_does_not_run(stranger, mesh_shape):
    stranger.write(shape=mesh_shape(str(stranger.secret)))
    status, said = stranger.command("run", stranger.scene, "--out", stranger.home / "out", "--quiet")
    assert (status, "shape.file" in said) == (2, True)
    assert not (stranger.home / "out").exists()


def test_what_users_allow_is_read(stranger, mesh_shape, monkeypatch):
    stranger.write(shape=mesh_shape(str(stranger.secret)))
    monkeypatch.setenv("TIDEMILL_ALLOW", str(stranger.secret.parent))
    stranger.accepted()
    monkeypatch.setenv("TIDEMILL_ALLOW", "")
    stranger.accepted("--allow", stranger.secret.parent)
    monkeypatch.setenv("TIDEMILL_ALLOW", str(stranger.home / "priv"))
    stranger.refused("shape.file")


def test_what_cannot_be_allowed_is_refused(stranger):
    stranger.write()
    status, said = stranger.command("check", stranger.scene, "--allow", stranger.home / "absent")
    assert (status, "no such folder" in said) == (2, True)


def test_files_of_the_project_are_read(stranger, mesh_shape):
    models = stranger.project / "scenes" / "models"
    models.mkdir()
    trimesh.creation.box((0.1, 0.1, 0.1)).export(models / "box.ply")
    for file in ("../models/box.ply", str(models / "box.ply"), str(ROOT / "scenes" / "models" / "bowl.ply")):
        stranger.write(shape=mesh_shape(file))
        stranger.accepted()
    assert resolve("pymeshfix:examples/StanfordBunny.ply", stranger.folder).is_file()


def test_a_folder_of_scenes_may_be_a_link(stranger, mesh_shape):
    trimesh.creation.box((0.1, 0.1, 0.1)).export(stranger.folder.parent / "box.ply")
    stranger.write(shape=mesh_shape("../box.ply"))
    place = stranger.home / "elsewhere"
    os.rename(stranger.project / "scenes", place)
    (stranger.project / "scenes").symlink_to(place)
    stranger.accepted()


@pytest.mark.parametrize("file", ["private:secret.ply", "pymeshfix:../trimesh/version.py", "__main__:secret.ply"])
def test_no_package_that_is_none(stranger, mesh_shape, monkeypatch, file):
    """A folder beside the program that runs could be imported, and is no package that was installed."""
    monkeypatch.syspath_prepend(stranger.home)
    monkeypatch.setattr(sys.modules["__main__"], "__spec__", None)
    stranger.write(shape=mesh_shape(file))
    stranger.refused("shape.file", file)


@pytest.mark.parametrize("file", ["pipe.ply", "/dev/zero", "", ".", "a\\0b", "secret.ply/x"])
def test_no_pipes_devices_and_names_that_are_none(stranger, file):
    os.mkfifo(stranger.folder / "pipe.ply")
    stranger.write(shape=f'{{type: mesh, file: "{file}"}}')
    stranger.refused("rigid.bodies.ball.shape.file")


EVERYWHERE = {
    "fluid": "fluid: {particle_radius: 0.05, bodies: {water: {shape: MESH}}}\n",
    "emitter": "fluid: {particle_radius: 0.05, emitters: {tap: {shape: FACE, speed: 1}}}\n",
    "drain": "fluid: {particle_radius: 0.05, bodies: {w: {shape: {type: box, size: [1, 1, 1]}}}, "
    "drains: {sink: {shape: MESH}}}\n",
    "cloth": "cloth: {sheets: {rag: {shape: MESH}}}\n",
    "container": "containers: {tank: {type: mesh, shape: MESH}}\n",
    "event": "events: [{at: 0.1, add: {rigid: {more: {shape: MESH}}}}]\n",
    "panorama": "render: {lights: {environment: {file: ~/private/sky.hdr}}}\n",
    "texture": "render: {materials: {ball: {type: plastic, texture: ~/private/wood.png}}}\n",
    "roughness": "render: {materials: {ball: {type: metal, roughness_map: ~/private/wood.png}}}\n",
    "normals": "render: {materials: {ball: {type: stone, normal_map: ~/private/wood.png}}}\n",
    "ground": "render: {ground: {material: {type: matte, texture: ~/private/wood.png}}}\n",
    "imported": "render: {materials: {ball: {type: imported, materials: [{base_map: {file: ~/private/wood.png}}]}}}\n",
}


@pytest.mark.parametrize("place", EVERYWHERE)
def test_wherever_a_scene_names_a_file(stranger, mesh_shape, place):
    mesh = mesh_shape("~/private/secret.ply")
    stranger.write(EVERYWHERE[place].replace("MESH", mesh).replace("FACE", mesh[:-1] + ", face: 0}"))
    stranger.refused(": asset '~/private/", "leads to", str(stranger.secret.parent))


def test_a_panorama_is_a_picture(stranger):
    """A film may be a list of addresses from which Blender would fetch its parts."""
    (stranger.folder / "sky.mp4").write_text("#EXTM3U\nhttp://127.0.0.1:9/\n")
    stranger.write("render: {lights: {environment: {file: sky.mp4}}}\n")
    stranger.refused("render.lights.environment.file", ".hdr, .exr")


@pytest.mark.parametrize(
    "look", ["texture: wood.mp4", "texture: wood.m3u8", "roughness_map: wood", "normal_map: w.mkv"]
)
def test_a_texture_is_a_picture(stranger, look):
    stranger.write(f"render: {{materials: {{ball: {{type: plastic, {look}}}}}}}\n")
    stranger.refused(f"render.materials.ball.{look.partition(':')[0]}", ".hdr, .exr")


def obj(library: str) -> bytes:
    return textured.obj(f"mtllib {library}\nusemtl paint\n").encode()


def mtl(image: str) -> bytes:
    return f"newmtl paint\nmap_Kd {image}\n".encode()


NAMES = ("../../../private/NAME", "HOME/private/NAME", "link/NAME", "pictures/../../../../private/NAME")
MATERIALS = {
    "library": lambda name: {"cube.obj": obj(name.replace("NAME", "secret.mtl"))},
    "image of a library": lambda name: {
        "cube.obj": obj("cube.mtl"),
        "cube.mtl": mtl(name.replace("NAME", "secret.png")),
    },
    "image of a GLB": lambda name: {"cube.glb": textured.glb(images=[{"uri": name.replace("NAME", "secret.png")}])},
    "image of a PLY": lambda name: {
        "cube.ply": textured.ply(f"comment TextureFile {name.replace('NAME', 'secret.png')}\n").encode()
    },
}
"""The files of a body that name a file of the user, by a name with NAME in it."""


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("case", MATERIALS)
def test_materials_of_a_mesh_lead_nowhere_else(stranger, mesh_shape, case, name):
    private = stranger.secret.parent
    (stranger.folder / "link").symlink_to(private)
    (private / "secret.png").write_bytes(textured.picture())
    (private / "secret.mtl").write_text("newmtl paint\nKd 1 0 0\n")
    files = MATERIALS[case](name.replace("HOME", str(stranger.home)))
    for file, content in files.items():
        (stranger.folder / file).write_bytes(content)
    stranger.write(shape=mesh_shape(next(iter(files))))
    stranger.refused("rigid.bodies.ball.shape.file", f"leads to {private}/secret", "--config allow=")
    stranger.accepted("--allow", private)


@pytest.mark.parametrize("address", ["http://127.0.0.1:9/wood.png", "file:///etc/wood.png", "smb://host/wood.png"])
@pytest.mark.parametrize("case", ["image of a library", "image of a GLB", "image of a PLY"])
def test_nothing_is_fetched(stranger, mesh_shape, case, address):
    files = MATERIALS[case](address)
    for file, content in files.items():
        (stranger.folder / file).write_bytes(content)
    stranger.write(shape=mesh_shape(next(iter(files))))
    stranger.refused("rigid.bodies.ball.shape.file", address, "nothing is fetched")


@pytest.mark.parametrize("name", ["pipe.png", "/dev/zero", "pictures", "wood\x07.png", "~/private/wood.png"])
def test_materials_name_no_pipes_and_devices(stranger, mesh_shape, name):
    os.mkfifo(stranger.folder / "pipe.png")
    (stranger.folder / "pictures").mkdir()
    (stranger.folder / "cube.obj").write_bytes(obj("cube.mtl"))
    (stranger.folder / "cube.mtl").write_bytes(mtl(name))
    stranger.write(shape=mesh_shape("cube.obj"))
    assert "\x07" not in stranger.refused("rigid.bodies.ball.shape.file")
    (stranger.folder / "cube.obj").write_bytes(obj(name))
    stranger.refused("rigid.bodies.ball.shape.file")


def test_a_library_is_not_without_end(stranger, mesh_shape):
    (stranger.folder / "cube.obj").write_bytes(obj("cube.mtl"))
    (stranger.folder / "cube.mtl").write_bytes(b"#" * 10_000_001)
    stranger.write(shape=mesh_shape("cube.obj"))
    stranger.refused("rigid.bodies.ball.shape.file", "no text of at most 10 MB")


def test_nor_are_materials(stranger, mesh_shape):
    (stranger.folder / "cube.glb").write_bytes(textured.glb(materials=[{}] * 1_001))
    stranger.write(shape=mesh_shape("cube.glb"))
    stranger.refused("rigid.bodies.ball.shape.file", "there are 1,001, at most 1,000")


@pytest.mark.parametrize("field", ["scene", "table"])
def test_a_study_reads_no_file_elsewhere(stranger, field):
    stranger.write()
    (stranger.secret.parent / "scene.yaml").write_text(stranger.scene.read_text())
    table = {"type": "table", "file": "~/private/table.csv" if field == "table" else "table.csv", "source": ""}
    (stranger.folder / "table.csv").write_text("0,0\n1,1\n")
    study = {
        **{"description": "", "scene": "../../../private/scene.yaml" if field == "scene" else "scene.yaml"},
        **{"grids": [{"rigid.max_step": ["20 ms"]}], "reference": table},
        "quantity": {"name": "height", "table": "bodies", "of": "ball", "column": "y", "take": "curve"},
    }
    path = stranger.folder / "study.yaml"
    path.write_text(json.dumps(study))
    with pytest.raises(SceneError, match=r"leads to .*private/") as refused:
        load_study(path, "study")
    assert ("scene" if field == "scene" else "reference.file") in str(refused.value)
