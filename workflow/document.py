"""A YAML file as plain data that remembers the line of every key.

YAML is read by the rules of version 1.2 where 1.1 surprises: `1e-4` is a number, `on` and `no`
are text, a key given twice is an error, and no Python object is ever constructed.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

Location = tuple[str | int, ...]

MAX_DEPTH = 40
MAX_VALUES = 100_000
"""Bounds that stop aliases which expand without end."""


class SceneError(Exception):
    """All that is wrong with a scene file, one block of text a problem."""

    def __init__(self, problems: Sequence[str]):
        super().__init__("\n\n".join(problems))
        self.problems = list(problems)


@dataclass(frozen=True)
class Mark:
    """Where a value stands: the name of its source, and the line in it (from 1; 0 means no line)."""

    source: str
    line: int = 0
    text: str = ""


@dataclass
class Document:
    """Plain data and the mark of every value in it."""

    source: str
    data: dict[str, Any]
    marks: dict[Location, Mark] = field(default_factory=dict)

    def mark(self, location: Location) -> Mark:
        """The mark of the value, or of the innermost group around it that the file has."""
        for end in range(len(location), 0, -1):
            if location[:end] in self.marks:
                return self.marks[location[:end]]
        return Mark(self.source)

    def problem(self, location: Location, message: str, remedy: str = "") -> str:
        """The text of an error: source, line, field, message, the line itself and the remedy."""
        mark = self.mark(location)
        place = f"{mark.source}:{mark.line}" if mark.line else mark.source
        name = dotted(location)
        text = f"{place}: {name}: {message}" if name else f"{place}: {message}"
        if mark.text.strip():
            text += f"\n  {mark.line:>4} | {mark.text.rstrip()}"
        return f"{text}\n  fix: {remedy}" if remedy else text

    def merge(self, below: Location, onto: Location = ()) -> Document:
        """A copy in which the mapping at `below` overrides the values at `onto`, key by key."""
        merged = Document(self.source, _copy(self.data), dict(self.marks))
        override = _at(self.data, below)
        if isinstance(override, dict):
            merged._override(onto, override, below)
        return merged

    def _override(self, location: Location, override: dict[str, Any], source: Location) -> None:
        target = _at(self.data, location)
        for key, value in override.items():
            here, there = (*location, key), (*source, key)
            if isinstance(value, dict) and isinstance(target.get(key), dict):
                self._override(here, value, there)
                continue
            target[key] = _copy(value)
            self.marks = {place: mark for place, mark in self.marks.items() if place[: len(here)] != here}
            moved = {here + place[len(there) :]: m for place, m in self.marks.items() if place[: len(there)] == there}
            self.marks.update(moved)

    def set(self, assignment: str) -> None:
        """Apply `path.to.key=value`, the value in YAML; raises SceneError where it can not be."""
        path, equals, text = assignment.partition("=")
        keys: Location = tuple(int(part) if part.isdigit() else part for part in path.strip().split("."))
        if not equals or "" in keys:
            raise SceneError([f"--set {assignment}: expected path.to.key=value\n  fix: --set fluid.viscosity=0.01"])
        value = parse(f"value: {text}", source=f"--set {assignment}").data["value"]
        target: Any = self.data
        for depth, key in enumerate(keys[:-1]):
            if isinstance(target, list) and isinstance(key, int) and key < len(target):
                target = target[key]
            elif isinstance(target, dict):
                if not isinstance(target.get(key), dict | list):
                    target[key] = {}
                target = target[key]
            else:
                raise SceneError([f"--set {assignment}: {dotted(keys[: depth + 1])} is not in the scene"])
        try:
            target[keys[-1]] = value
        except (IndexError, TypeError):
            raise SceneError([f"--set {assignment}: {dotted(keys)} is not in the scene"]) from None
        self.marks = {place: mark for place, mark in self.marks.items() if place[: len(keys)] != keys}
        self.marks[keys] = Mark(f"--set {assignment}")


def dotted(location: Iterable[str | int]) -> str:
    return ".".join(str(part) for part in location)


def suggestion(word: str, known: Iterable[str]) -> str:
    """`did you mean ...?` or the list of what is known."""
    known = sorted(known)
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.6)
    return f"did you mean '{close[0]}'?" if close else f"known here: {', '.join(known)}"


def read(path: Path) -> Document:
    """Read a scene file; raises SceneError."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        siblings = [other.name for other in path.parent.glob("*.yaml")] if path.parent.is_dir() else []
        hint = (
            suggestion(path.name, siblings) if siblings else "give the path of a scene file such as scenes/bunny.yaml"
        )
        raise SceneError([f"{path}: no such scene file\n  fix: {hint}"]) from None
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError([f"{path}: can not be read: {error}\n  fix: give a UTF-8 text file in YAML"]) from None
    return parse(text, source=str(path))


def parse(text: str, *, source: str) -> Document:
    """Parse YAML text; raises SceneError with the line of what is wrong."""
    lines = text.splitlines()
    try:
        root = yaml.compose(text, Loader=_Loader)
        if root is None:
            raise SceneError([f"{source}: the file is empty\n  fix: start from scenes/tiny/splash.yaml"])
        document = Document(source, {})
        loader = _Loader("")
        data = _construct(loader, root, (), document, lines)
        loader.dispose()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 0
        shown = f"\n  {line:>4} | {lines[line - 1]}" if 0 < line <= len(lines) else ""
        raise SceneError([f"{source}:{line}: {error.problem or error.context}{shown}"]) from None
    except yaml.YAMLError as error:
        raise SceneError([f"{source}: not YAML: {error}"]) from None
    if not isinstance(data, dict):
        raise SceneError([f"{source}:1: a scene is a mapping of settings\n  fix: start with `duration: 2`"])
    document.data = data
    return document


class _Loader(yaml.SafeLoader):
    """SafeLoader with the numbers and booleans of YAML 1.2."""


_Loader.yaml_implicit_resolvers = {
    first: [(tag, regexp) for tag, regexp in resolvers if tag.rpartition(":")[2] in {"null", "merge"}]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(?:true|True|false|False)$"), list("tTfF"))
_Loader.add_implicit_resolver("tag:yaml.org,2002:int", re.compile(r"^[-+]?[0-9]+$"), list("-+0123456789"))
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf)|\.(?:nan|NaN))$"),
    list("-+.0123456789"),
)


def _construct_float(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> float:
    return float(
        loader.construct_scalar(node).replace(".inf", "inf").replace(".Inf", "inf").lower().replace(".nan", "nan")
    )


def _construct_int(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> int:
    return int(loader.construct_scalar(node))


_Loader.add_constructor("tag:yaml.org,2002:float", _construct_float)
_Loader.add_constructor("tag:yaml.org,2002:int", _construct_int)


def _construct(loader: _Loader, node: yaml.Node, location: Location, document: Document, lines: list[str]) -> Any:
    line = node.start_mark.line + 1
    if not node.tag.startswith("tag:yaml.org,2002:") or "python" in node.tag:
        remedy = "remove the tag: settings are plain numbers, text, lists and mappings"
        document.marks[location] = Mark(document.source, line, lines[line - 1])
        raise SceneError([document.problem(location, f"the YAML tag '{node.tag}' is not allowed", remedy)])
    if len(location) > MAX_DEPTH or len(document.marks) > MAX_VALUES:
        raise SceneError([f"{document.source}:{line}: more nesting or more values than a scene can have"])
    document.marks.setdefault(location, Mark(document.source, line, lines[line - 1] if line <= len(lines) else ""))
    if isinstance(node, yaml.SequenceNode):
        return [_construct(loader, item, (*location, i), document, lines) for i, item in enumerate(node.value)]
    if not isinstance(node, yaml.MappingNode):
        return loader.construct_object(node)
    _refuse_duplicates(node, location, document, lines)
    loader.flatten_mapping(node)
    data: dict[str, Any] = {}
    for key_node, value_node in node.value:
        key = str(key_node.value)
        document.marks[(*location, key)] = Mark(
            document.source, key_node.start_mark.line + 1, lines[key_node.start_mark.line]
        )
        data[key] = _construct(loader, value_node, (*location, key), document, lines)
    return data


def _refuse_duplicates(node: yaml.MappingNode, location: Location, document: Document, lines: list[str]) -> None:
    first: dict[str, int] = {}
    for key_node, _ in node.value:
        key, line = str(key_node.value), key_node.start_mark.line + 1
        if key in first:
            document.marks[(*location, key)] = Mark(document.source, line, lines[line - 1])
            message = f"'{key}' is given twice, first in line {first[key]}"
            remedy = "give each body, and each key, a name of its own"
            raise SceneError([document.problem((*location, key), message, remedy)])
        first[key] = line


def _copy(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copy(item) for key, item in value.items()}
    return [_copy(item) for item in value] if isinstance(value, list) else value


def _at(data: Any, location: Location) -> Any:
    for part in location:
        data = data[part] if isinstance(data, dict) and part in data else {}
    return data
