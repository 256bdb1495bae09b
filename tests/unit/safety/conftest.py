"""A scene from a stranger, beside files of the user that it must not reach. docs/safety.md lists what it tries."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
import trimesh

from sim.__main__ import main

SCENE = """\
duration: 0.5
fps: 4
rigid:
  bodies:
    ball: {shape: SHAPE, motion: dynamic, density: 500, position: [0, 1, 0]}
"""
BALL = "{type: sphere, radius: 0.1}"


class Stranger:
    """A project whose folder of scenes has one that a stranger wrote."""

    def __init__(self, home: Path, capsys: pytest.CaptureFixture[str]):
        self.home = home
        self.project = home / "project"
        self.folder = self.project / "scenes" / "stranger"
        self.scene = self.folder / "scene.yaml"
        self.secret = home / "private" / "secret.ply"
        self.ran = home / "ran"
        self._capsys = capsys
        for folder in (self.folder, self.secret.parent):
            folder.mkdir(parents=True)
        trimesh.creation.box((0.1, 0.1, 0.1)).export(self.secret)
        self.program = self.folder / "evil.sh"
        self.program.write_text(f"#!/bin/sh\ntouch {self.ran}\n")
        self.program.chmod(0o755)

    def write(self, more: str = "", shape: str = BALL) -> Path:
        self.scene.write_text(SCENE.replace("SHAPE", shape) + more, encoding="utf-8")
        return self.scene

    def command(self, *words: object) -> tuple[int, str]:
        """Exit status of `python -m sim WORDS`, and all that it printed."""
        try:
            status = main([*map(str, words)])
        except SystemExit as error:
            status = int(error.code or 0)
        printed = self._capsys.readouterr()
        return status, printed.out + printed.err

    def accepted(self, *options: object) -> str:
        status, said = self.command("check", self.scene, "--quality", "draft", *options)
        assert status == 0, said
        return said

    def refused(self, field: str, *words: str, options: tuple[object, ...] = ()) -> str:
        """What `check` says, which names the field, its line, these words and a remedy; nothing ran."""
        status, said = self.command("check", self.scene, "--quality", "draft", *options)
        assert status == 2, said
        assert "Traceback" not in said and "\n  fix: " in said
        for word in (f"{self.scene}:", field, *words):
            assert word in said, said
        assert not self.ran.exists()
        return said


@pytest.fixture
def stranger(tmp_path: Path, capsys, monkeypatch) -> Stranger:
    for name in ("TIDEMILL_ALLOW", "TIDEMILL_BLENDER"):
        monkeypatch.setenv(name, "")
    monkeypatch.setenv("HOME", str(tmp_path))
    found = Stranger(tmp_path, capsys)
    monkeypatch.chdir(found.project)
    return found


@pytest.fixture
def mesh_shape() -> Callable[[str], str]:
    """The shape of a mesh file, as it stands in a scene."""
    return lambda file: f"{{type: mesh, file: {file!r}}}"
