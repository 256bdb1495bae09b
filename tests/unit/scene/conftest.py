"""A scene to make mistakes in, and the command that finds them.

`pytest tests/unit/scene --answers docs/mistakes.md` writes what was typed and what it was answered.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.unit.scene import answers

SCENE = """\
duration: 0.5
fps: 12
quality: draft
containers:
  tank: {type: box, size: [0.8, 1, 0.8]}
fluid:
  particle_radius: 25 mm
  bodies:
    drop:
      shape: {type: box, size: [0.3, 0.3, 0.3]}
      position: [0, 0.62, 0]
rigid:
  bodies:
    ball:
      shape: {type: sphere, radius: 0.18}
      position: [0, 0.2, 0]
"""


@pytest.fixture(autouse=True, scope="session")
def _cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TIDEMILL_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


class Bench:
    """Writes scene files into a folder of its own and checks them."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str], properties: list[tuple[str, object]]):
        self.folder = folder
        self.path = folder / "bad.yaml"
        self._capsys = capsys
        self._properties = properties

    def write(self, text: str | bytes) -> Path:
        self.path.write_bytes(text.encode() if isinstance(text, str) else text)
        return self.path

    def check(self, *options: str, path: Path | None = None) -> tuple[int, str]:
        """Exit status of `python -m sim check`, and all that it printed."""
        from sim.__main__ import main

        try:
            status = main(["check", str(path or self.path), *options])
        except SystemExit as error:
            status = error.code
        printed = self._capsys.readouterr()
        said = printed.out + printed.err
        if path is None:
            found = answers.answer(self.path.read_bytes(), SCENE, options, said.replace(f"{self.folder}/", ""))
            self._properties.append(("answer", found))
        return status, said

    def accepts(self, text: str, *options: str) -> str:
        self.write(text)
        status, said = self.check("--quality", "draft", *options)
        assert status == 0, said
        return said

    def refuses(self, text: str | bytes, *words: str, at: str = "", options: tuple[str, ...] = ()) -> str:
        """The refusal; it names the file, the line that holds `at`, the words and a remedy."""
        self.write(text)
        status, said = self.check("--quality", "draft", *options)
        assert status == 2, said
        assert "Traceback" not in said and "Warning" not in said
        assert "\n  fix: " in said
        for word in words:
            assert word in said, said
        if at:
            lines = text.decode("utf-8-sig").splitlines() if isinstance(text, bytes) else text.split("\n")
            [number] = [index for index, line in enumerate(lines, 1) if at in line]
            assert f"{self.path}:{number}: " in said, said
        return said


@pytest.fixture
def bench(tmp_path: Path, capsys, monkeypatch, request) -> Bench:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").mkdir()
    return Bench(tmp_path / "scenes", capsys, request.node.user_properties)


@pytest.fixture
def scene() -> Callable[..., str]:
    """The text of a valid scene, with `old` replaced by `new`, and lines `more` at its end."""

    def build(old: str = "", new: str = "", more: str = "") -> str:
        assert old in SCENE
        return (SCENE.replace(old, new, 1) if old else SCENE) + (f"{more}\n" if more else "")

    return build


@pytest.fixture(scope="session")
def project() -> Path:
    return Path(os.path.abspath(__file__)).parents[3]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--answers", metavar="FILE", help="write what was typed and what it was answered, as Markdown")


_answered: dict[str, list[tuple[str, list[str]]]] = {}


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.when == "call" and report.passed:
        _answered[report.nodeid] = [found for name, found in report.user_properties if name == "answer" and found]


def pytest_terminal_summary(config: pytest.Config) -> None:
    path = config.getoption("--answers", default=None)
    if path and not hasattr(config, "workerinput"):
        Path(path).write_text(answers.page(_answered), encoding="utf-8")
