"""Settings that stand at another level than the one where they belong: indented too far, or too little."""

from __future__ import annotations

import functools
import types
import typing
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from scene.document import Location, dotted

NAME = "NAME"
"""Stands in the path of a setting for a name that the scene gives, or for a place in a list."""
MOST = 3
"""A key that belongs to more groups than these is told to belong to none."""

Path = tuple[str, ...]


@dataclass(frozen=True)
class Levels:
    """All paths of a model: of each key, and of the groups, with the models that they may be of."""

    keys: dict[str, list[Path]]
    groups: dict[Path, list[type[BaseModel]]]
    by_name: list[Path]
    """Groups of which there may be any number, by their names."""

    def models(self, location: Location) -> list[type[BaseModel]]:
        """What the group at a location may be."""
        return [model for path, models in self.groups.items() if _matches(path, location) for model in models]

    def names(self, location: Location) -> bool:
        """Whether the last part of a location is a name that the scene gives."""
        return any(_matches(path, location) for path in self.by_name)


@functools.cache
def levels(model: type[BaseModel]) -> Levels:
    """Of a model of settings; found once and kept."""
    found = Levels({}, {}, [])
    _walk(model, (), found)
    return found


def home(key: str, location: Location, value: Any, model: type[BaseModel]) -> str:
    """Where a key that is unknown in the group at `location` belongs, and what to do; empty where that is not known."""
    found = levels(model)
    groups = found.models(location) if isinstance(value, dict) and value else []
    fields = [field for group in groups for field in _that_hold(value, group)]
    if fields:
        shown = [dotted((*location, *fields))] if len(fields) == 1 else fields
        return f"indent `{key}:` below {' or '.join(f'`{field}:`' for field in shown)}, where names stand"
    if key not in found.keys and any(value.keys() <= group.model_fields.keys() for group in groups):
        return f"leave `{key}:` out, and indent less what stands below it"
    paths = [path for path in found.keys.get(key, ()) if not _matches(path[:-1], location)]
    if any(len(path) == 1 for path in paths):
        return "it belongs to the scene itself: begin it at the left margin"
    nearest = max((_common(path, location) for path in paths), default=0)
    paths = [path for path in paths if _common(path, location) == nearest]
    if (not nearest and location) or not paths:
        return ""
    least = min(map(len, paths)) if nearest else None
    parents = sorted({_shown(path[:-1], location) for path in paths if len(path) == (least or len(path))})
    if len(parents) > MOST:
        return ""
    listed = " or ".join(f"`{parent}`" for parent in parents)
    return f"it belongs to {listed}: indent it below that"


def _that_hold(value: dict[str, Any], group: type[BaseModel]) -> list[str]:
    """The groups by name in a group of which a value may be a member."""
    return [
        field
        for field, info in group.model_fields.items()
        for steps, member in _members(info.annotation)
        if steps == (NAME,) and value.keys() <= member.model_fields.keys()
    ]


@dataclass(frozen=True)
class Misplaced:
    """Settings that stand beside the names that they are for."""

    location: Location
    settings: list[str]
    empty: list[str]
    """Names that nothing stands below."""
    between: bool = False
    """Whether it is a group between the names and their own group."""

    def covers(self, location: Location) -> bool:
        """Whether a problem there follows from this one."""
        end = len(self.location)
        return location[:end] == self.location and location[end : end + 1] in {(n,) for n in self.settings + self.empty}

    def problem(self) -> tuple[Location, str, str]:
        """Where it is, what is wrong, and what would be right."""
        listed = ", ".join(f"`{name}:`" for name in self.settings)
        if self.between:
            message = f"names stand directly in `{dotted(self.location)}`"
            return (
                (*self.location, self.settings[0]),
                message,
                f"leave {listed} out, and indent less what stands below it",
            )
        if len(self.empty) == 1:
            name = self.empty[0]
            verb = "is a setting" if len(self.settings) == 1 else "are settings"
            message = f"is empty, and what stands beside it, {listed}, {verb} of it"
            return (*self.location, name), message, f"indent {listed} further than `{name}:`"
        message = f"this is a setting of each in `{dotted(self.location)}`, and no name of one"
        return (*self.location, self.settings[0]), message, "indent it further, below the name that it is for"


def misplaced(data: Any, model: type[BaseModel]) -> Iterator[Misplaced]:
    """Settings of bodies, sheets and the like in the place of their names."""
    found = levels(model)
    for path in found.by_name:
        for location, group in _at(data, path[:-1]):
            if not isinstance(group, dict):
                continue
            for member in found.groups[path]:
                due = {name for name, info in member.model_fields.items() if info.is_required()}
                own = [
                    key
                    for key, value in group.items()
                    if key in member.model_fields and not (isinstance(value, dict) and due & value.keys())
                ]
                empty = [key for key, value in group.items() if value is None and key not in own]
                if own:
                    yield Misplaced(location, own, empty)
                for key, value in group.items():
                    if _holds_names(value, member, due):
                        yield Misplaced(location, [key], [], between=True)


def _holds_names(value: Any, member: type[BaseModel], due: set[str]) -> bool:
    """Whether a value is no member of a group by name, but holds some."""
    if not isinstance(value, dict) or not value or value.keys() & member.model_fields.keys():
        return False
    return all(isinstance(inner, dict) and due & inner.keys() for inner in value.values())


def _walk(model: type[BaseModel], path: Path, found: Levels) -> None:
    found.groups.setdefault(path, []).append(model)
    for key, info in model.model_fields.items():
        here = (*path, key)
        if here not in found.keys.setdefault(key, []):
            found.keys[key].append(here)
        for steps, member in _members(info.annotation):
            below = (*here, *steps)
            if steps[-1:] == (NAME,) and _is_by_name(info.annotation) and below not in found.by_name:
                found.by_name.append(below)
            _walk(member, below, found)


def _members(annotation: Any) -> list[tuple[Path, type[BaseModel]]]:
    """The groups of settings that an annotation leads to, and what is between."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [((), annotation)]
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        return _members(arguments[0])
    if origin in (typing.Union, types.UnionType):
        return [member for argument in arguments for member in _members(argument)]
    if origin in (dict, tuple, list):
        return [((NAME, *steps), member) for argument in arguments for steps, member in _members(argument)]
    return []


def _is_by_name(annotation: Any) -> bool:
    if typing.get_origin(annotation) is typing.Annotated:
        return _is_by_name(typing.get_args(annotation)[0])
    return typing.get_origin(annotation) is dict


def _matches(path: Path, location: Location) -> bool:
    return len(path) == len(location) and _common(path, location) == len(path)


def _common(path: Path, location: Location) -> int:
    """How many parts of a path and a location are the same from the beginning on."""
    for index, (one, other) in enumerate(zip(path, location, strict=False)):
        if one not in (NAME, other):
            return index
    return min(len(path), len(location))


def _shown(path: Path, location: Location) -> str:
    common = _common(path, location)
    return dotted((*location[:common], *path[common:]))


def _at(data: Any, path: Path, location: Location = ()) -> Iterator[tuple[Location, Any]]:
    """What the data has at a path, and where."""
    if not path:
        yield location, data
    elif isinstance(data, dict):
        for key in data if path[0] == NAME else {path[0]} & data.keys():
            yield from _at(data[key], path[1:], (*location, key))
    elif isinstance(data, list) and path[0] == NAME:
        for index, item in enumerate(data):
            yield from _at(item, path[1:], (*location, index))
