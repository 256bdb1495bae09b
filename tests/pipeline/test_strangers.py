"""Scenes of strangers through Snakemake: names are no orders to the shell, and programs and folders come from the user.

docs/safety.md says what else a scene may not do; tests/unit/safety has what `check` alone finds.
"""

from __future__ import annotations

import pytest

BALL = """\
duration: 0.25
fps: 4
rigid:
  bodies:
    ball: {shape: {type: sphere, radius: 0.1}, motion: dynamic, position: [0, 1, 0]}
render: {samples: 1, resolution: [32, 18]}
"""
NAME = "-a b;$(touch ran)`touch ran`'q\" %d &|<é"
"""What an option parser, a shell, ffmpeg and Matplotlib would take for orders, each in its way."""


@pytest.fixture
def program(fresh):
    """One that a stranger would like to have started."""
    path = fresh.scene.with_name("evil.sh")
    path.write_text(f"#!/bin/sh\ntouch {fresh.folder / 'ran'}\n")
    path.chmod(0o755)
    return path


def refused(ran, *words: str) -> None:
    assert ran.code != 0
    assert "Traceback" not in ran.text
    for word in words:
        assert word in ran.text, ran.text


@pytest.fixture
def private(fresh):
    """A folder beside the project, with the mesh of the stone."""
    folder = fresh.folder.parent / "private"
    folder.mkdir()
    fresh.scene.with_name("stone.obj").rename(folder / "stone.obj")
    return folder


@pytest.mark.slow
def test_a_name_is_no_order_and_a_folder_is_read_if_the_user_says_so(fresh, private):
    shape = f"{{type: mesh, file: {private}/stone.obj}}"
    fresh.scene.with_name(f"{NAME}.yaml").write_text(BALL.replace("{type: sphere, radius: 0.1}", shape))
    ran = fresh.snakemake("--cores", "1", f"renders/tests/{NAME}", "--config", f"allow={private}")
    assert ran.code == 0, ran.text
    assert (fresh.folder / "renders" / "tests" / NAME / f"{NAME}.mp4").stat().st_size > 0
    assert not list(fresh.folder.rglob("ran"))


def test_otherwise_it_is_not(fresh, private):
    fresh.edit("file: stone.obj", f"file: {private}/stone.obj")
    refused(fresh.snakemake("-n", "renders/tests/pond"), "pond.yaml:13", "shape.file", f"--config allow={private}")


def test_a_scene_starts_no_program(fresh, program):
    fresh.edit("  samples: 1", "  samples: 1\n  blender: scenes/tests/evil.sh")
    said = ("pond.yaml:19: render.blender: a scene cannot say which program renders", "--config blender=PATH")
    refused(fresh.snakemake("--cores", "1", "renders/tests/pond"), *said)
    assert not (fresh.folder / "ran").exists()


def test_the_user_says_which_blender_renders(project):
    """It is part of what pictures are made with: others are made anew, by the program that is named."""
    program = project.folder / "my blender"
    program.write_text('#!/bin/sh\necho started "$0"\nexit 1\n')
    program.chmod(0o755)
    option = ("--config", f"blender={program}")
    for ran in (project.dry_run("renders/tests/pond", *option), project.dry_run(TIDEMILL_BLENDER=str(program))):
        assert ran.stages == {"render", "film"} and "Params have changed" in str(ran.reasons("render"))
    ran = project.snakemake("--cores", "1", "results/tests/pond/standard/frames/000", *option)
    refused(ran, f"{program} ended with exit code 1", f"started {program}")
