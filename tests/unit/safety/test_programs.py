"""Nothing starts a program that a scene, a study or a file of settings names."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from render.__main__ import main as render
from scene.document import SceneError
from workflow.study.load import load_study

ROOT = Path(__file__).parents[3]
STARTING = {
    *("render/blender/installed.py", "workflow/stages/film/encode.py", "workflow/running/process.py"),
    *("workflow/plan/foreseen.py", "workflow/budget/pilot.py", "workflow/study/trial.py"),
    *("workflow/formats/animation.py", "workflow/gallery/collect.py", "workflow/gallery/looks/pictures.py"),
}
"""What starts programs: the Blender that the user names, ffmpeg, and commands of our own."""
WAYS = {
    "in render": "render: {blender: ./evil.sh}\n",
    "in a preset": "presets: {draft: {render: {blender: ./evil.sh}}}\n",
    "at the top": "blender: ./evil.sh\n",
    "in a wedge": "wedge: {render.blender: [./evil.sh, ./evil.sh]}\n",
}


@pytest.mark.parametrize("way", WAYS)
def test_a_scene_cannot_say_which_program_renders(stranger, way):
    stranger.write(WAYS[way])
    said = stranger.refused("blender", "cannot say which program renders")
    for remedy in ("--config blender=PATH", "--blender PATH", "TIDEMILL_BLENDER=PATH"):
        assert remedy in said


def test_nor_can_an_override(stranger):
    stranger.write()
    status, said = stranger.command("check", stranger.scene, "--set", f"render.blender={stranger.program}")
    assert (status, "TIDEMILL_BLENDER" in said) == (2, True)


def test_nor_can_an_event(stranger):
    stranger.write("events: [{at: 0.1, set: {render.blender: ./evil.sh}}]\n")
    stranger.refused("events.0.set.render.blender")


def test_nor_can_a_study(stranger):
    stranger.write()
    study = {
        **{"description": "", "scene": "scene.yaml", "stage": "render", "set": {"render.blender": "./evil.sh"}},
        **{"grids": [{"render.samples": [1, 2]}], "quantity": {"name": "picture", "table": "picture"}},
        **{"reference": {"type": "trial", "set": {"render.samples": 4}}},
    }
    path = stranger.folder / "study.yaml"
    path.write_text(json.dumps(study))
    with pytest.raises(SceneError, match="TIDEMILL_BLENDER"):
        load_study(path, "study")


@pytest.mark.parametrize("place", [{}, {"materials": {"ball": {"type": "matte", "build": "os:system"}}}])
def test_nor_can_a_file_of_settings(stranger, capsys, place):
    spec = stranger.folder / "spec.json"
    spec.write_text(json.dumps(place or {"blender": str(stranger.program)}))
    words = ["--simulation", str(stranger.folder), "--frames", "0:0", "--out", str(stranger.home / "out")]
    assert render(["--spec", str(spec), *words]) == 2
    assert ("build" if place else "blender") in capsys.readouterr().err
    assert not stranger.ran.exists()


def test_programs_are_started_where_it_is_known():
    chapters = ("common", "scene", "sim", "render", "workflow", "live")
    files = [file for chapter in chapters for file in ROOT.glob(f"{chapter}/**/*.py")]
    starting = re.compile(r"subprocess\.(?:run|Popen|call|check)|os\.(?:system|popen|exec|spawn|startfile)|shell=True")
    found = {file.relative_to(ROOT).as_posix() for file in files if starting.search(file.read_text())}
    assert found == STARTING
    assert not [file for file in files if "shell=True" in file.read_text()]
