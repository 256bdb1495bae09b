"""Mesh files that cannot be simulated."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from tests.support.meshes import without_mass, write

REFUSED = without_mass()
BALL = "{type: sphere, radius: 0.18}"

OFF_NAN = "OFF\n4 4 0\n0 0 0\n1 0 nan\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"


def ask(bench, scene, file: str, *words: str) -> None:
    text = scene(BALL, f'{{type: mesh, file: "{file}"}}')
    bench.refuses(text, "rigid.bodies.ball.shape.file", *words, at="type: mesh")


def test_a_missing_mesh_brings_the_close_name(bench, scene):
    trimesh.creation.box().export(bench.folder / "bunny.ply")
    ask(bench, scene, "bumny.ply", "'bumny.ply' does not exist", "id you mean bunny.ply?")


def test_a_missing_package(bench, scene):
    ask(bench, scene, "no_such_package:a.ply", "'no_such_package' is not installed")
    ask(bench, scene, "pymeshfix:../secret.ply", "leads out of the package")


def test_a_folder_and_an_impossible_path(bench, scene):
    ask(bench, scene, ".", "is a folder")
    ask(bench, scene, "a\\0b.ply", "control character")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("text.ply", b"this is no mesh"),
        ("text.stl", b"this is no mesh"),
        ("mesh.unknown", b"this is no mesh"),
        ("noise.ply", bytes(range(256))),
        ("zero.obj", b""),
        ("nan.off", OFF_NAN.encode()),
        ("points.off", b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"),
    ],
)
def test_a_file_without_a_usable_mesh(bench, scene, name, content):
    (bench.folder / name).write_bytes(content)
    ask(bench, scene, name, name)


def test_meshes_that_enclose_nothing(bench, scene):
    flat = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    flat.export(bench.folder / "flat.ply")
    ask(bench, scene, "flat.ply", "flat.ply", "encloses a volume")
    random = np.random.default_rng(3)
    soup = trimesh.Trimesh(random.random((60, 3)), np.arange(60).reshape(20, 3), process=False)
    soup.export(bench.folder / "soup.ply")
    ask(bench, scene, "soup.ply", "soup.ply", "encloses a volume")


def test_an_open_mesh_that_must_not_be_mended(bench, scene):
    box = trimesh.creation.box()
    box.update_faces(np.arange(len(box.faces)) > 0)
    box.export(bench.folder / "open.ply")
    text = scene(BALL, "{type: mesh, file: open.ply, repair: false}")
    bench.refuses(text, "rigid.bodies.ball.shape.file", "3 open edges", "et repair: true", at="type: mesh")


def test_what_was_mended_is_said(bench, scene):
    box = trimesh.creation.box().subdivide().subdivide()
    box.update_faces(np.arange(len(box.faces)) > 0)
    box.export(bench.folder / "open.ply")
    assert "ball: closed 1 hole" in bench.accepts(scene(BALL, "{type: mesh, file: open.ply, size: 0.2}"))


@pytest.mark.parametrize("name", REFUSED)
def test_a_body_that_has_no_mass(bench, scene, name):
    build, says = REFUSED[name]
    write(bench.folder / "bad.off", build())
    text = scene(BALL, "{type: mesh, file: bad.off}\n      motion: dynamic")
    bench.refuses(text, "rigid.bodies.ball.shape", says, at="type: mesh")
