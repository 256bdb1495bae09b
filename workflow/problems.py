"""What a validation error means to whoever wrote the scene."""

from __future__ import annotations

import types
import typing
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from workflow.document import Document, Location, suggestion


def explain(error: ValidationError, document: Document, model: type[BaseModel]) -> list[str]:
    """One text a problem: place, field, what is wrong, what would be right."""
    problems: dict[str, None] = {}
    for detail in error.errors(include_url=False):
        path = _path_in_document(detail["loc"], document.data)
        message, remedy = _explain(detail, path, model)
        problems[document.problem(path, message, remedy)] = None
    return list(problems)


def _path_in_document(loc: tuple[str | int, ...], data: Any) -> Location:
    """`loc` without the tags that pydantic adds for the chosen member of a union."""
    path: list[str | int] = []
    for index, part in enumerate(loc):
        if isinstance(data, dict) and part in data:
            data = data[part]
        elif isinstance(data, list) and isinstance(part, int) and part < len(data):
            data = data[part]
        elif index < len(loc) - 1 or not isinstance(data, dict):
            continue
        path.append(part)
    return tuple(path)


def _explain(detail: Any, path: Location, model: type[BaseModel]) -> tuple[str, str]:
    kind, context, given = detail["type"], detail.get("ctx", {}), detail["input"]
    group, unit = _context(model, detail["loc"])
    shown = f", got {given!r}" if isinstance(given, int | float | str | bool) or given is None else ""
    in_unit = f" [{unit}]" if unit else ""
    if kind == "extra_forbidden":
        return f"unknown key '{path[-1]}'", suggestion(str(path[-1]), group)
    if kind == "missing":
        described = f" [{unit}]" if unit else ""
        return "missing", f"add `{path[-1]}:`{described}"
    bounds = {
        "greater_than": ("greater than", "gt"),
        "greater_than_equal": ("at least", "ge"),
        "less_than": ("less than", "lt"),
        "less_than_equal": ("at most", "le"),
    }
    if kind in bounds:
        words, key = bounds[kind]
        return f"must be {words} {context[key]:g}{in_unit}{shown}", f"give a number {words} {context[key]:g}{in_unit}"
    if kind == "union_tag_invalid":
        tags = [tag.strip().strip("'") for tag in str(context["expected_tags"]).split(",")]
        return f"unknown type '{context['tag']}'", suggestion(str(context["tag"]), tags)
    if kind == "union_tag_not_found":
        return "missing its type", f"add {context['discriminator']}: with the kind you want"
    if kind == "literal_error":
        allowed = context["expected"].replace("'", "").replace(" or ", ", ").split(", ")
        return f"must be {context['expected']}{shown}", suggestion(str(given), allowed)
    if kind == "quantity":
        return detail["msg"], f"give a number in {unit}, or a quantity in a unit of that kind" if unit else ""
    if kind in {"float_type", "float_parsing", "int_type", "int_parsing", "int_from_float"}:
        return f"must be a number{in_unit}{shown}", f"give a plain number{in_unit}"
    if kind in {"tuple_type", "list_type"}:
        return f"must be a list{shown}", "write a list, as [0, 1, 0]"
    if kind in {"model_type", "dict_type", "model_attributes_type"}:
        return f"must be a group of settings{shown}", "indent its keys below it"
    if kind == "string_pattern_mismatch":
        return f"not a valid name{shown}", "names start with a letter and hold letters, digits, - and _"
    return detail["msg"].removeprefix("Value error, ") + (shown if kind != "value_error" else ""), ""


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
