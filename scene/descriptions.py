"""What settings mean: the docstring below each, as the JSON schema's descriptions.

pydantic can read these itself while a class is made, but then every dry-run would wait for it.
"""

from __future__ import annotations

import ast
import functools
import inspect
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from scene.settings import Settings


def meanings(settings: type[Settings]) -> dict[str, str]:
    """Docstring by field, those of base classes included."""
    found: dict[str, str] = {}
    for group in reversed(settings.__mro__):
        if issubclass(group, Settings):
            found |= dict(_docstrings(_definition(group)))
    return {name: text for name, text in found.items() if name in settings.model_fields}


class WithMeanings(GenerateJsonSchema):
    """Adds the docstring of every field that has no other description."""

    def model_schema(self, schema: Any) -> dict[str, Any]:
        node = super().model_schema(schema)
        for name, text in meanings(schema["cls"]).items():
            node["properties"][name].setdefault("description", text)
        return node


def _docstrings(definition: ast.ClassDef) -> Iterator[tuple[str, str]]:
    for field, below in pairwise(definition.body):
        match field, below:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                yield name, inspect.cleandoc(text)


def _definition(group: type) -> ast.ClassDef:
    return next(
        node
        for node in ast.walk(_parsed(inspect.getfile(group)))
        if isinstance(node, ast.ClassDef) and node.name == group.__name__
    )


@functools.cache
def _parsed(file: str) -> ast.Module:
    return ast.parse(Path(file).read_text(encoding="utf-8"))
