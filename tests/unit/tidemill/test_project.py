"""`tidemill new`: what is made, what is copied, and that nothing is overwritten."""

from __future__ import annotations

import filecmp
import json

import pytest

from scene.load import load
from scene.presets import QUALITIES
from tidemill import DISTRIBUTION
from tidemill.project import main


def new(*arguments: str) -> int:
    return main(arguments, "tidemill new")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("name", "scene"),
    [
        ("film", "film"),
        ("a/b/shot_3", "shot_3"),
        ("mes films d'été", "mes_films_d_ete"),
        ("_-films-_", "films"),
        ("映画", "first"),
    ],
)
def test_a_folder_with_a_first_scene(folder, name, scene, capsys):
    assert new(name) == 0
    found = sorted(path.relative_to(folder / name).as_posix() for path in (folder / name).rglob("*") if path.is_file())
    assert found == sorted(
        [".gitignore", "Snakefile", "profiles/default/config.yaml", f"scenes/{scene}.yaml", "scenes/schema.json"]
    )
    assert f"tidemill render {scene} --quality draft" in capsys.readouterr().out
    json.loads((folder / name / "scenes" / "schema.json").read_text())
    for quality in QUALITIES:
        assert load(folder / name / "scenes" / f"{scene}.yaml", quality=quality).simulation.fluid is not None


def test_the_first_scene_says_what_its_settings_are_for():
    text = (DISTRIBUTION / "tidemill/template/scenes/first.yaml").read_text()
    assert text.startswith("# yaml-language-server: $schema=schema.json\n")
    groups = [line for line in text.splitlines() if line[:1].isalpha() and line.endswith(":")]
    assert len([line for line in text.splitlines() if line.lstrip().startswith("#")]) >= len(groups)


def test_a_scene_is_copied_with_what_it_names(folder):
    assert new("film", "--from", "bowl") == 0
    for name in ("bowl.yaml", "models/bowl.ply", "models/water.ply"):
        assert filecmp.cmp(folder / "film/scenes" / name, DISTRIBUTION / "scenes" / name, shallow=False)
    assert not (folder / "film/scenes/film.yaml").exists()


def test_scenes_join_a_folder(folder, monkeypatch, capsys):
    new("film")
    monkeypatch.chdir(folder / "film")
    assert new("--from", "bowl") == 0
    assert new("--from", "tiny/splash") == 0
    assert (folder / "film/scenes/tiny/splash.yaml").is_file()
    (folder / "film/scenes/bowl.yaml").write_text("mine")
    assert new("--from", "bowl") == 2
    assert "bowl.yaml is there already" in capsys.readouterr().err
    assert (folder / "film/scenes/bowl.yaml").read_text() == "mine"


def test_a_model_of_ones_own_is_not_overwritten(folder, monkeypatch, capsys):
    new("film")
    monkeypatch.chdir(folder / "film")
    (folder / "film/scenes/models").mkdir()
    (folder / "film/scenes/models/bowl.ply").write_text("mine")
    assert new("--from", "bowl") == 2
    assert "models/bowl.ply is there already" in capsys.readouterr().err
    assert not (folder / "film/scenes/bowl.yaml").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give the folder a name"),
        (["full"], "full is there already"),
        (["file"], "file is there already"),
        (["film", "--from", "bowel"], "did you mean 'bowl'?"),
        (["film", "--from", "../bowl"], "no scene '../bowl' comes with Tidemill"),
    ],
)
def test_what_cannot_be_made(folder, arguments, message, capsys):
    (folder / "full").mkdir()
    (folder / "full" / "notes.txt").touch()
    (folder / "file").touch()
    assert new(*arguments) == 2
    assert message in capsys.readouterr().err
    assert not (folder / "film").exists()
