"""Scene files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scene.document import SceneError
from scene.load import load
from scene.reader import read
from tests.fuzz.mutations import broken, broken_bytes, fuzzed

ROOT = Path(__file__).resolve().parents[2]
NAMES = ["bunny", "pouring", "hammock", "wreckage", "tiny/drain", "tiny/splash", "tiny/tap"]
SIGNS = (b"\t", b"\n", b": ", b"- ", b"{", b"]", b"&a ", b"*a", b"!!int ", b"? ", b'"', "é".encode(), b"9", b"<<: ")


def original(name: str) -> Path:
    return ROOT / "scenes" / f"{name}.yaml"


@pytest.fixture
def survives(tmp_path, survived):
    """Loads what is written as a scene file; anything but SceneError fails the test."""
    path = tmp_path / "scenes" / "scene.yaml"
    path.parent.mkdir()

    def check(content: bytes, *overrides: str) -> None:
        path.write_bytes(content)
        with survived(SceneError):
            load(path, quality="draft", overrides=overrides, root=tmp_path)

    return check


@pytest.mark.parametrize("name", NAMES)
def test_values(name, survives):
    data = read(original(name)).data

    @fuzzed(40)
    @given(broken(data))
    def check(changed):
        survives(json.dumps(changed).replace("NaN", ".nan").replace("Infinity", ".inf").encode())

    check()


@pytest.mark.parametrize("name", NAMES)
def test_bytes(name, survives):
    @fuzzed(40)
    @given(broken_bytes(original(name).read_bytes(), SIGNS))
    def check(changed):
        survives(changed)

    check()


WORDS = st.sampled_from(["fluid", "bodies", "drop", "position", "0", "9", "", "gravity", "x", "=", "[", "²", "-1", ":"])
PATHS = st.lists(WORDS | st.text(max_size=5), min_size=1, max_size=4).map(".".join)


def test_overrides(survives):
    content = original("tiny/splash").read_bytes()

    @fuzzed(80)
    @given(PATHS, st.sampled_from(["1", "", "[", "{a: b}", "x", "1e-4", "10 mm"]) | st.text(max_size=10))
    def check(path, value):
        survives(content, f"{path}={value}")

    check()
