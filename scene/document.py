"""The data of a scene file, which remembers the line of every value: overrides, assignments, texts of errors."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

Location = tuple[str | int, ...]


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

    def value(self, location: Location) -> Any:
        """What stands there."""
        value: Any = self.data
        for part in location:
            value = value[part]
        return value

    def problem(self, location: Location, message: str, remedy: str = "") -> str:
        """The text of an error: source, line, field, message, the line itself and the remedy."""
        mark = self.mark(location)
        place = f"{mark.source}:{mark.line}" if mark.line else mark.source
        name = dotted(location)
        text = f"{place}: {name}: {message}" if name else f"{place}: {message}"
        if mark.text.strip():
            text += f"\n  {mark.line:>4} | {mark.text.rstrip()[:150]}"
        return f"{text}\n  fix: {remedy[0].lower() + remedy[1:]}" if remedy else text

    def merge(self, below: Location, onto: Location = ()) -> Document:
        """A copy in which the mapping at `below` overrides the values at `onto`, key by key."""
        merged = Document(self.source, _copy(self.data))
        override = _at(self.data, below)
        moved: dict[Location, Location] = {}
        if isinstance(override, dict):
            _override(_at(merged.data, onto), override, below, onto, moved)
        replaced = set(moved.values())
        merged.marks = {place: mark for place, mark in self.marks.items() if _within(place, replaced) is None}
        for place, mark in self.marks.items():
            origin = _within(place, moved)
            if origin is not None:
                merged.marks[moved[origin] + place[len(origin) :]] = mark
        return merged

    def put(self, keys: Location, value: Any, source: str) -> None:
        """Set a value that comes from a `source` without lines, and make the groups on the way to it; raises SceneError
        where there is no such place."""
        marks = {place: mark for place, mark in self.marks.items() if place[: len(keys)] != keys}
        marks[keys] = Mark(source)
        target: Any = self.data
        for depth, key in enumerate(keys):
            here = dotted(keys[: depth + 1])
            if isinstance(target, list) and not (isinstance(key, int) and key < len(target)):
                raise SceneError(
                    [f"{source}: {here} is not in the scene\n  fix: the list has the entries 0 to {len(target) - 1}"]
                )
            if not isinstance(target, dict | list):
                raise SceneError(
                    [f"{source}: {here} is not in the scene\n  fix: {dotted(keys[:depth])} holds one value: set that"]
                )
            place: Any = str(key) if isinstance(target, dict) else key
            if depth == len(keys) - 1:
                target[place] = value
                continue
            if isinstance(target, dict) and target.get(place) is None:
                target[place] = {}
                marks[keys[: depth + 1]] = Mark(source)
            target = target[place]
        self.marks = marks


def dotted(location: Iterable[str | int]) -> str:
    """The parts of a location with dots between them, as messages name a setting."""
    return ".".join(str(part) for part in location)


def _override(
    target: dict[str, Any], override: dict[str, Any], source: Location, onto: Location, moved: dict[Location, Location]
) -> None:
    for key, value in override.items():
        if isinstance(value, dict) and isinstance(target.get(key), dict):
            _override(target[key], value, (*source, key), (*onto, key), moved)
        else:
            target[key] = _copy(value)
            moved[(*source, key)] = (*onto, key)


def _within(place: Location, groups: Container[Location]) -> Location | None:
    """The outermost beginning of `place` that is one of `groups`."""
    return next((place[:end] for end in range(1, len(place) + 1) if place[:end] in groups), None)


def _copy(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copy(item) for key, item in value.items()}
    return [_copy(item) for item in value] if isinstance(value, list) else value


def _at(data: Any, location: Location) -> Any:
    for part in location:
        data = data[part] if isinstance(data, dict) and part in data else {}
    return data
