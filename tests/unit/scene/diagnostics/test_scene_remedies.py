"""Whatever is refused, it is said what to do: no error of a scene ends without a remedy of its own."""

from __future__ import annotations

import ast

import pytest

FOLDERS = ("common", "scene", "sim", "render", "workflow")


def raised(source: str) -> list[str]:
    """What validators of settings raise, by their sources."""
    groups = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ClassDef)]
    validators = [
        function
        for group in groups
        for function in group.body
        if isinstance(function, ast.FunctionDef) and any("validator" in ast.unparse(d) for d in function.decorator_list)
    ]
    return [
        ast.unparse(node.exc)
        for function in validators
        for node in ast.walk(function)
        if isinstance(node, ast.Raise) and node.exc and ast.unparse(node.exc).startswith("ValueError(")
    ]


def test_every_validator_says_what_to_do(project):
    """`what is wrong: what to do`, of which `scene.diagnostics.wrong_values.said` makes the two parts of an answer."""
    found = {
        (path.relative_to(project), error)
        for folder in FOLDERS
        for path in (project / folder).rglob("*.py")
        for error in raised(path.read_text())
    }
    assert len(found) > 40
    assert not [where for where in found if ": " not in where[1]]


SET = {
    "a number for a list": ("gravity: 3", "gravity: must be a list, got 3", "write a list, as [0, 1, 0]"),
    "a list for a number": (
        "rigid.bodies.ball.friction: [1]",
        "ball.friction: must be a number",
        "give a plain number",
    ),
    "out of bounds": ("rigid.bodies.ball.restitution: 3", "restitution: must be at most 1, got 3", "number at most 1"),
    "a word of none": (
        "rigid.bodies.ball.motion: dynamik",
        "must be 'static', 'prescribed' or 'dynamic', got 'dynamik'",
    ),
    "a unit of another kind": ("fluid.viscosity: 1 m", "expected a number in m^2/s", "got '1 m'"),
    "a group that does not go together": (
        "rigid.bodies.ball: {shape: {type: sphere, radius: 0.18}, mass: 1, density: 1}",
        "mass and density exclude each other",
        "remove one of them",
    ),
}


@pytest.mark.parametrize("case", SET)
def test_what_an_event_sets_is_answered_as_what_stands_in_the_scene(bench, scene, case):
    line, *words = SET[case]
    said = bench.refuses(scene(more=f"events:\n  - at: 0.1\n    set:\n      {line}"), *words)
    assert "Input should" not in said and "Value error" not in said
