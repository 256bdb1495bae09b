"""What was meant by a value of another kind than the setting wants: a comment for a colour, a text for a list."""

from __future__ import annotations

import re
from typing import Any

from scene.notation import meant, numbers, unquoted

_NUMBERS = frozenset({"float_type", "float_parsing", "int_type", "int_parsing", "int_from_float"})
_LISTS = frozenset({"tuple_type", "list_type"})
_COMMENT = re.compile(r":\s+(#[0-9A-Fa-f]{3,8})\b")
"""A colour that YAML takes for a comment."""
_DECIMAL_COMMA = re.compile(r"(?<![\d.])(\d+),(\d+)(?![\d.])")
_NOTHING = frozenset({"none", "no", "nothing", "null", "off", "false"})

_AXES = {"x": "[1, 0, 0]", "y": "[0, 1, 0]", "z": "[0, 0, 1]"}


def remedy(kind: str, given: Any, line: str, unit: str) -> str:
    """What would be right, by the kind of the error that pydantic found, what was given, the line that it stands in,
    and the unit of numbers that are wanted; empty where that is not known."""
    if given is None:
        return of_comment(line) or ("write [] for none, or remove the key" if kind in _LISTS else "")
    if isinstance(given, str):
        return _of_text(kind, given, unit)
    if kind in _LISTS and isinstance(given, dict) and given and given.keys() <= set("xyz"):
        return f"write [{', '.join(str(given.get(axis, 0)) for axis in 'xyz')}]"
    if kind in {"too_long", "missing"} and (comma := _DECIMAL_COMMA.search(line)) and isinstance(given, list):
        return f"give as many values as are due; if {comma[0]} is one number, write {comma[1]}.{comma[2]}"
    if kind in _LISTS and unit == "m/s^2" and isinstance(given, int | float) and not isinstance(given, bool):
        return f"write [0, {-abs(given):g}, 0]: y is up"
    if kind == "dict_type" and isinstance(given, list):
        return "give each a name of its own in place of the `-`, as `ball:`, and indent its settings below"
    if kind == "model_type" and isinstance(given, list):
        return "write its settings without `-`, below it"
    return ""


def of_comment(line: str) -> str:
    """What to do about a line in which a colour is a comment."""
    found = _COMMENT.search(line)
    return f"put {found[1]} in quotes, as '{found[1]}': YAML takes it for a comment" if found else ""


def _of_text(kind: str, given: str, unit: str) -> str:
    if kind in _NUMBERS:
        return meant(given)
    if kind in _LISTS:
        if given.strip().lower() in _NOTHING:
            return "write [] for none"
        if unit == "1" and given in _AXES:
            return f"write {_AXES[given]}"
        values = numbers(given) or ([] if unit else [given])
        if values:
            return f"write [{', '.join(values)}]"
    if kind == "model_attributes_type" and given.isidentifier():
        return f"write {{type: {given}, ...}} with its settings"
    bare = unquoted(given)
    return f"write {bare} without these quotes" if bare != given and kind != "color" else ""
