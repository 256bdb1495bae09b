"""`tidemill COMMAND`: what it calls, and what it says."""

from __future__ import annotations

import os
import sys

import pytest

from tidemill import SNAKEFILE, films
from tidemill.commands import COMMANDS, call


class Became(Exception):
    """Another program, in place of this one."""


@pytest.fixture
def snakemake(monkeypatch, tmp_path):
    """What Snakemake is called with, in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def become(program, words):
        assert program == sys.executable and words[:3] == [program, "-m", "snakemake"]
        raise Became(words[3:])

    monkeypatch.setattr(os, "execv", become)

    def given(*arguments: str) -> list[str]:
        with pytest.raises(Became) as became:
            call(arguments)
        return became.value.args[0]

    return given


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_under_its_own_name(name, capsys):
    with pytest.raises(SystemExit) as ended:
        call([name, "--help"])
    said = capsys.readouterr().out
    assert ended.value.code == 0
    assert said.startswith(f"usage: tidemill {name} ") and "python -m" not in said


def test_what_there_is(capsys):
    assert call([]) == 0
    said = capsys.readouterr().out
    assert all(f"\n  {name} " in said for name in COMMANDS)


@pytest.mark.parametrize(("word", "fix"), [("chek", "did you mean 'check'?"), ("zzz", "known here: check, ")])
def test_a_command_that_does_not_exist(word, fix, capsys):
    with pytest.raises(SystemExit) as ended:
        call([word])
    assert ended.value.code == 2
    assert f"no command '{word}'\n  fix: {fix}" in capsys.readouterr().err


def test_scenes_that_come_with_it_are_listed_anywhere(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "mine.yaml").write_text("description: A film of my own.\nduration: 2\n")
    call(["scenes"])
    own, shipped = capsys.readouterr().out.split("Scenes that come with Tidemill:")
    assert "renders/mine" in own and "renders/bunny" not in own
    assert "renders/bunny" in shipped and "tidemill render NAME" in own


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["render", "bunny"], ["renders/bunny"]),
        (["render", "a", "b", "-n", "-c", "2"], ["renders/a", "renders/b", "--dry-run", "--cores", "2"]),
        (["render", "a", "--quality", "draft"], ["renders/a", "--config", "quality=draft"]),
        (["render", "a", "--blender", "/b c"], ["renders/a", "--config", "blender=/b c"]),
        (["wedge", "a", "--allow", "/x"], ["wedges/a", "--config", "allow=/x"]),
        (["render", "a", "--error", "10%"], ["renders/a", "--config", "error=10%"]),
        (
            ["render", "a", "--set", "fps=12", "--set", "gravity=[0, -1, 0]"],
            ["renders/a", "--config", 'set=["fps=12", "gravity=[0, -1, 0]"]'],
        ),
        (
            ["render", "a", "--keep", "film", "--", "--forcerun", "film"],
            ["renders/a", "--forcerun", "film", "--config", "keep=film"],
        ),
        (["render", "a", "--", "--config", "quality=draft"], ["renders/a", "--config", "quality=draft"]),
        (["study", "incline"], ["studies/incline"]),
        (["wedge", "syrup", "--", "--quiet"], ["wedges/syrup", "--quiet"]),
    ],
)
def test_films_are_made_by_snakemake(snakemake, arguments, words):
    assert snakemake(*arguments)[-len(words) :] == words


def test_rules_and_profile_come_with_it_where_a_folder_has_none(snakemake, tmp_path):
    words = snakemake("render", "bunny")
    assert words[words.index("--snakefile") + 1] == SNAKEFILE
    (tmp_path / "Snakefile").touch()
    assert "--snakefile" not in snakemake("render", "bunny")
    assert "--workflow-profile" in snakemake("render", "bunny")
    (tmp_path / films.PROFILE).mkdir(parents=True)
    assert snakemake("render", "bunny") == ["renders/bunny"]


def test_settings_come_in_one_way(capsys):
    with pytest.raises(SystemExit) as ended:
        call(["render", "bunny", "--quality", "draft", "--", "--config", "keep=film"])
    assert ended.value.code == 2
    assert "--quality and --config cannot both be given" in capsys.readouterr().err
