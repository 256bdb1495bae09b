"""What a validation error means to whoever wrote the scene."""

from __future__ import annotations

import itertools
import types
import typing
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from scene.diagnostics import slips
from scene.diagnostics.levels import home, levels, misplaced
from scene.diagnostics.suggestions import similar, suggestion
from scene.diagnostics.wrong_values import BOUNDS, KINDS, LIST, reason, shown_as
from scene.document import Document, Location, SceneError, dotted

ELSEWHERE = (
    "remove it; an installed Blender is named by --config blender=PATH with snakemake, --blender PATH with "
    "python -m render, or TIDEMILL_BLENDER=PATH"
)


Model = TypeVar("Model", bound=BaseModel)


def validated(document: Document, model: type[Model]) -> Model:
    """What a document says, as settings of a kind; raises SceneError, a text a problem."""
    try:
        return model.model_validate(document.data)
    except ValidationError as error:
        raise SceneError(explain(error, document, model)) from None


def explain(error: ValidationError, document: Document, model: type[BaseModel]) -> list[str]:
    """One text a problem: place, field, what is wrong, what would be right."""
    found = [(_path_in_document(detail, document.data), detail) for detail in error.errors(include_url=False)]
    groups = [group for group in misplaced(document.data, model) if any(group.covers(path) for path, _ in found)]
    problems = dict.fromkeys(document.problem(*group.problem()) for group in groups)
    for path, detail in found:
        if any(group.covers(path) for group in groups) or _follows(path, detail, found, model):
            continue
        message, remedy = _explain(detail, path, document, model)
        problems[document.problem(path, message, remedy)] = None
    return list(problems)


def _follows(path: Location, detail: Any, found: list[tuple[Location, Any]], model: type[BaseModel]) -> bool:
    """Whether a problem is only what another one leads to."""
    if detail["type"] == "missing" and isinstance(detail["loc"][-1], int):
        due = [other["loc"][-1] for place, other in found if place == path and other["type"] == "missing"]
        return detail["loc"][-1] < max(due) or any(len(place) > len(path) == _common(place, path) for place, _ in found)
    if detail["type"] == "missing":
        unknown = [(place, other) for place, other in found if other["type"] == "extra_forbidden"]
        return any(_stands_for(place, other, path, model) for place, other in unknown)
    one_of_words = any(place == path and other["type"] == "literal_error" for place, other in found)
    return detail["type"] == "model_type" and isinstance(detail["input"], str) and one_of_words


def _stands_for(unknown: Location, detail: Any, missing: Location, model: type[BaseModel]) -> bool:
    """Whether an unknown key is the missing one, misspelt or at another level."""
    key, group, wanted, due = str(unknown[-1]), unknown[:-1], missing[:-1], str(missing[-1])
    if group == wanted:
        if isinstance(detail["input"], dict) and due in detail["input"]:
            return True
        known = _context(model, detail["loc"])[0]
        return similar(key, known) == [due] or f"`{dotted(missing)}:`" in home(key, group, detail["input"], model)
    return key == due and _common(group, wanted) == min(len(group), len(wanted))


def _common(one: Location, other: Location) -> int:
    """How many parts two locations have in common from the beginning on."""
    same = (a == b for a, b in zip(one, other, strict=False))
    return sum(itertools.takewhile(bool, same))


def _path_in_document(detail: Any, data: Any) -> Location:
    """Where the problem lies: without the tags that pydantic adds for the chosen member of a union.

    A validator of a whole group tells the key that it means by beginning its message with it.
    """
    path: list[str | int] = []
    for index, part in enumerate(detail["loc"]):
        listed = isinstance(data, list) and isinstance(part, int) and part < len(data)
        if listed or (isinstance(data, dict) and part in data):
            data = data[part]
        elif index < len(detail["loc"]) - 1 or detail["type"] != "missing" or not isinstance(data, dict):
            continue
        path.append(part)
    if detail["type"] == "value_error" and isinstance(data, dict):
        path += [key for key in detail["msg"].removeprefix("Value error, ").replace(":", "").split()[:1] if key in data]
    return tuple(path)


def _explain(detail: Any, path: Location, document: Document, model: type[BaseModel]) -> tuple[str, str]:
    """What is wrong, and what would be right."""
    message, remedy = _told(detail, path, document, model)
    unit = _context(model, detail["loc"])[1]
    return message, slips.remedy(detail["type"], detail["input"], document.mark(path).text, unit) or remedy


def _told(detail: Any, path: Location, document: Document, model: type[BaseModel]) -> tuple[str, str]:
    """The same by the kind of the error alone."""
    kind, context, given = detail["type"], detail.get("ctx", {}), detail["input"]
    group, unit = _context(model, detail["loc"])
    shown, in_unit = shown_as(given), f" [{unit}]" if unit not in {"", "1"} else ""
    if kind == "extra_forbidden" and path[-1] == "blender":
        return "a scene cannot say which program renders", ELSEWHERE
    if kind == "extra_forbidden":
        return f"unknown key '{path[-1]}'", _known_as(str(path[-1]), path[:-1], given, group, model)
    if kind == "missing":
        return _missing(detail, path, in_unit, document, model)
    if kind in BOUNDS:
        message, remedy = reason(detail, in_unit)
        most = context[BOUNDS[kind][1]]
        millimetres = unit == "m" and "less" in kind and isinstance(given, int | float) and given / 1000 <= most
        return message, f"{remedy}, or '{given:g} mm' if millimetres were meant" if millimetres else remedy
    if kind == "union_tag_invalid":
        tags = [tag.strip().strip("'") for tag in str(context["expected_tags"]).split(",")]
        return f"unknown type '{context['tag']}'", suggestion(str(context["tag"]), tags)
    if kind == "union_tag_not_found":
        return "missing its type", f"add `{context['discriminator'].strip(chr(39))}:` with the kind you want"
    if kind == "color" and context.get("remedy"):
        return f"is not a colour{shown}", context["remedy"]
    if kind == "quantity":
        example = "" if unit in {"", "1"} else ", or a quantity in a unit of that kind"
        return detail["msg"], context.get("remedy") or f"give a plain number{in_unit}{example}"
    if kind == "too_long" and isinstance(given, list):
        return _wrong_length(context["max_length"], len(given), in_unit)
    if kind == "too_short" and isinstance(given, dict):
        return "is empty", "name at least one thing in it, or remove the whole group"
    if kind == "string_pattern_mismatch" and "mp4" in context["pattern"]:
        return f"must end in .mp4{shown}", "give a path such as gallery/film.mp4"
    if KINDS.get(kind) is LIST and (items := levels(model).models((*path, 0))):
        return _list_of_groups(given, items[0], shown)
    return reason(detail, in_unit)


def _list_of_groups(given: Any, item: type[BaseModel], shown: str) -> tuple[str, str]:
    """Of a list of groups of settings that is none."""
    if not isinstance(given, dict):
        due = ", ".join(f"{key}: ..." for key, info in item.model_fields.items() if info.is_required())
        return f"must be a list{shown}", f"write a list, as [{{{due}}}]"
    if not given.keys() & item.model_fields.keys() and all(isinstance(value, dict) for value in given.values()):
        return "must be a list, got groups by name", "write a `-` in place of each name"
    group = ", ".join(f"{key}: ..." for key in given)
    return "must be a list, got one group", f"put it in a list, as [{{{group}}}]"


def _known_as(key: str, group: Location, given: Any, known: list[str], model: type[BaseModel]) -> str:
    """What an unknown key was meant for: one that looks like it, or the same at another level."""
    return ("" if similar(key, known) else home(key, group, given, model)) or suggestion(key, known)


def _missing(detail: Any, path: Location, in_unit: str, document: Document, model: type[BaseModel]) -> tuple[str, str]:
    last = detail["loc"][-1]
    given = detail["input"]
    if isinstance(last, int) and isinstance(given, list | tuple):
        return _wrong_length(last + 1, len(given), in_unit)
    remedy = f"add `{path[-1]}:`{in_unit}"
    if levels(model).names(path[:-1]):
        # A preset, a wedge or --set may be about another one of these.
        others = similar(str(path[-2]), document.value(path[:-2]).keys() - {path[-2]})
        remedy += f", or did you mean '{others[0]}'?" if others else ""
    return "missing", remedy


def _wrong_length(due: int, given: int, in_unit: str) -> tuple[str, str]:
    return f"must be a list of {due} values{in_unit}, got {given}", f"give {due} values"


def _context(model: type[BaseModel], loc: tuple[str | int, ...]) -> tuple[list[str], str]:
    """The keys known in the group that `loc` lies in, and the unit of the field itself."""
    annotation: Any = model
    known, unit = list(model.model_fields), ""
    for part in loc:
        unit = ""
        chosen = _member(annotation, part)
        if chosen is not None:
            annotation = chosen
            if isinstance(chosen, type) and issubclass(chosen, BaseModel):
                known = list(chosen.model_fields)
            continue
        base = _models(annotation)
        if base and part in base[0].model_fields:
            known = list(base[0].model_fields)
            info = base[0].model_fields[str(part)]
            annotation, unit = info.annotation, _unit(info)
            if inner := _models(annotation):
                known = list(inner[0].model_fields) if part != loc[-1] else known
        elif arguments := [a for a in typing.get_args(_strip(annotation)) if a is not ...]:
            annotation = arguments[-1]
            unit = _unit(annotation)
            if inner := _models(annotation):
                known = list(inner[0].model_fields)
    return known, unit


def _unit(annotation: Any) -> str:
    if isinstance(annotation, FieldInfo):
        own = next((item.symbol for item in annotation.metadata if hasattr(item, "symbol")), "")
        return own or _unit(annotation.annotation)
    metadata = getattr(annotation, "__metadata__", ())
    own = next((item.symbol for item in metadata if hasattr(item, "symbol")), "")
    return own or next((u for a in typing.get_args(annotation) if (u := _unit(a))), "")


def _strip(annotation: Any) -> Any:
    while typing.get_origin(annotation) is typing.Annotated:
        annotation = typing.get_args(annotation)[0]
    if typing.get_origin(annotation) in (typing.Union, types.UnionType):
        rest = [a for a in typing.get_args(annotation) if a is not type(None)]
        return _strip(rest[0]) if len(rest) == 1 else annotation
    return annotation


def _models(annotation: Any) -> list[type[BaseModel]]:
    annotation = _strip(annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if typing.get_origin(annotation) in (typing.Union, types.UnionType):
        return [model for a in typing.get_args(annotation) for model in _models(a)]
    return []


def _member(annotation: Any, tag: str | int) -> Any:
    """The member of a discriminated union that `tag` names, or None."""
    models = _models(annotation)
    if len(models) < 2:
        return None
    for model in models:
        info = model.model_fields.get("type")
        if info is not None and tag in typing.get_args(info.annotation):
            return model
    return None
