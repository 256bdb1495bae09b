"""Documents mutated at random are loaded or refused with a SceneError: nothing else ever escapes."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from workflow.document import SceneError, read
from workflow.scene import load

VALUES = [
    *(None, True, False, 0, -1, 1, 3, 1e-30, 1e30, -1e300, 10**400, float("nan"), float("inf")),
    *("", "x", "ball", "10 mm", "3 s", "1e999 m", "box", "mesh", "../x", "\0", "é" * 300, "<<", "#ffffff"),
    *([], [0], [0, 0, 0], [[1], 2, {}], {}, {"type": "box"}, {"type": "mesh", "file": "x"}, {"": 1}, {"a": {"b": 1}}),
]


def mutate(data, dice: random.Random):
    """Change one place of a document: replace, remove, rename, repeat or nest a value."""
    places = []

    def visit(group):
        for key in list(group) if isinstance(group, dict) else range(len(group)):
            places.append((group, key))
            if isinstance(group[key], dict | list):
                visit(group[key])

    visit(data)
    if not places:
        return
    group, key = dice.choice(places)
    match dice.randrange(6):
        case 0:
            del group[key]
        case 1 if isinstance(group, dict):
            group[dice.choice(["", "type", "bodies", "at", "0", "set", f"{key}x"])] = group.pop(key)
        case 2:
            group[key] = [group[key]]
        case 3:
            other, there = dice.choice(places)
            group[key] = json.loads(json.dumps(other[there])) if there in other or isinstance(there, int) else None
        case _:
            group[key] = dice.choice(VALUES)


def survives(path: Path) -> bool:
    try:
        load(path, quality="draft")
    except SceneError as error:
        assert str(error)
        return False
    return True


SOURCES = ["bunny", "pouring", "tiny/drain", "tiny/splash", "tiny/still", "tiny/tap"]


@pytest.mark.parametrize("name", SOURCES)
def test_mutated_documents(bench, project, name):
    dice = random.Random(name)
    original = json.dumps(read(project / "scenes" / f"{name}.yaml").data)
    loaded = 0
    for _ in range(150):
        data = json.loads(original)
        for _ in range(dice.randint(1, 3)):
            try:
                mutate(data, dice)
            except (IndexError, KeyError):
                continue  # an earlier change took the place away
        loaded += survives(bench.write(json.dumps(data).replace("NaN", ".nan").replace("Infinity", ".inf")))
    assert loaded > 0


@pytest.mark.parametrize("name", SOURCES)
def test_mutated_text(bench, project, name):
    dice = random.Random(name)
    original = (project / "scenes" / f"{name}.yaml").read_text()
    for _ in range(150):
        text = original
        for _ in range(dice.randint(1, 4)):
            start = dice.randrange(len(text))
            piece = dice.choice(
                ["", "\t", "\n", ": ", "- ", "{", "]", "&a ", "*a", "!!int ", "? ", '"', "é", "9", "<<: "]
            )
            text = text[:start] + piece + text[start + dice.randrange(4) :]
        survives(bench.write(text))


def test_mutated_bytes(bench, scene):
    dice = random.Random(1)
    for _ in range(100):
        content = bytearray(scene().encode())
        for _ in range(dice.randint(1, 5)):
            content[dice.randrange(len(content))] = dice.randrange(256)
        survives(bench.write(bytes(content)))


def test_mutated_overrides(bench, scene):
    dice = random.Random(2)
    bench.write(scene())
    words = ["fluid", "bodies", "drop", "position", "0", "9", "", "gravity", "x", "=", "[", "1", "²", "-1", ":"]
    for _ in range(300):
        override = (
            ".".join(dice.choices(words, k=dice.randint(1, 4))) + "=" + dice.choice(["1", "", "[", "{a: b}", "x"])
        )
        try:
            load(bench.path, quality="draft", overrides=[override])
        except SceneError as error:
            assert str(error)
