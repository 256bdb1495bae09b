"""Texts of a scene are data: they construct nothing, compute nothing but numbers, and order nothing."""

from __future__ import annotations

import re
import time
from pathlib import Path

import pytest

from scene.document import SceneError
from scene.settings import Refused
from workflow.plan.shelf import SCENE_FILES
from workflow.study.formula import evaluate

ROOT = Path(__file__).parents[3]
LAUGHS = "a0: &a0 [x, x]\n" + "".join(f"a{level}: &a{level} [{f'*a{level - 1}, ' * 10}]\n" for level in range(1, 12))
PROMPTLY = 10.0
"""Far from the hours, or the memory, that these would take [s]."""


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ("x: !!python/object/apply:os.system [touch ran]\n", "tag"),
        ("x: !!python/object/new:os.system [touch ran]\n", "tag"),
        ("x: !!python/name:os.system\n", "tag"),
        (LAUGHS, "more nesting or more values"),
        ("x: &x [*x]\n", "more nesting or more values"),
        (f"x: {'[' * 1000}\n", "more nesting or more values"),
        ('description: "\\e[31mred"\n', "U+001B"),
        ('description: "a\\0b"\n', "U+0000"),
    ],
)
def test_yaml_is_data(stranger, more, says):
    stranger.write(more)
    start = time.monotonic()
    stranger.refused("", says)
    assert time.monotonic() < start + PROMPTLY


@pytest.mark.parametrize("quantity", ["9**9**9**9 m", "__import__('os').system('touch ran')", "1e999 m"])
def test_a_quantity_is_a_number_and_a_unit(stranger, quantity):
    stranger.write(shape=f'{{type: sphere, radius: "{quantity}"}}')
    stranger.refused("rigid.bodies.ball.shape.radius")


FORMULAS = [
    *("3999999**3999999 * 3999999**3999999", "9**9**9**9", "1 << 9999999", "'ab' * 99999 * 9", "f'{1:>9999999999}'"),
    *("__import__('os').system('touch ran')", "().__class__.__mro__", "sqrt.__self__", "'{0.__class__}'.format(1)"),
    *("(lambda: 1)()", "[1 for x in (1, 2)]", "-" * 1500 + "1", "+".join(["1"] * 900), "(" * 900 + "1" + ")" * 900),
    "1 + " * 10_000 + "1",
]


@pytest.mark.parametrize("formula", FORMULAS)
def test_a_formula_computes_numbers(formula):
    start = time.monotonic()
    with pytest.raises(Refused):
        evaluate(formula)
    assert time.monotonic() < start + PROMPTLY


@pytest.mark.parametrize(
    "name", ["a{b}", "a\nb", "a\x1b[31m", "../scene", "/etc/passwd", "stranger/../../x", "a\udcff"]
)
def test_names_of_scenes_are_names_of_their_files(stranger, name):
    stranger.write()
    (stranger.project / "scenes" / f"{name.replace('/', '')}.yaml").write_text(stranger.scene.read_text())
    says = "there is no scene" if "/" in name else "cannot be the name of a scene"
    with pytest.raises(SceneError, match=says):
        SCENE_FILES.find(name)
    assert "stranger/scene" in SCENE_FILES.names() and name not in SCENE_FILES.names()


RULES = sorted(ROOT.glob("workflow/rules/*.smk"))
UNQUOTED = {
    *("params.frames", "params.fps", "params.stage", "params.limit", "threads", "resources.attempt", "resources.arch"),
    *("wildcards.quality", "wildcards.segment", "wildcards.block", "wildcards.trial", "wildcards.repeat"),
}
"""Numbers, and words of which the rules know all; `arch` is given on the command line."""


@pytest.mark.parametrize("file", RULES, ids=lambda file: file.stem)
def test_shells_are_given_quoted_texts(file):
    shells = re.findall(r"^    shell:\n((?:        .*\n)+)", file.read_text(), re.MULTILINE)
    fields = {field for shell in shells for field in re.findall(r"\{([^{}]+)\}", shell)}
    assert {field for field in fields if not field.endswith(":q")} <= UNQUOTED
    assert "shell=True" not in file.read_text()
