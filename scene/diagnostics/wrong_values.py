"""What is wrong with a value, and what to do, in the words of who writes scenes."""

from __future__ import annotations

from typing import Any

from scene.diagnostics.suggestions import suggestion

BOUNDS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}

NUMBER = ("must be a number", "give a plain number")
WHOLE = ("must be a whole number", "give a number without fraction or unit")
LIST = ("must be a list", "write a list, as [0, 1, 0]")
GROUP = ("must be a group of settings", "indent its keys below it")
FLAG = ("must be true or false", "write true or false")
TEXT = ("must be text", "put it in quotes")
KINDS = {
    **dict.fromkeys(("float_type", "float_parsing", "finite_number"), NUMBER),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float", "int_parsing_size"), WHOLE),
    **dict.fromkeys(("tuple_type", "list_type"), LIST),
    **dict.fromkeys(("model_type", "dict_type", "model_attributes_type"), GROUP),
    **dict.fromkeys(("bool_type", "bool_parsing"), FLAG),
    "string_type": TEXT,
    "color": ("is not a colour", "write '#3a7bd5', or three numbers from 0 to 1 as [0.2, 0.5, 0.8]"),
    "string_too_short": ("must not be empty", "give it a text, or remove the key"),
    "string_pattern_mismatch": ("is not a valid name", "names start with a letter and hold letters, digits, - and _"),
}


def shown_as(given: Any) -> str:
    """What was given, as YAML writes it; nothing for lists and groups."""
    if given is None:
        return ", got nothing"
    if isinstance(given, bool):
        return f", got {str(given).lower()}"
    if isinstance(given, int | float | str):
        text = repr(given)
        return f", got {text if len(text) <= 80 else text[:77] + '...'}"
    return ""


def said(message: str) -> tuple[str, str]:
    """What a validator says, `what is wrong: what to do`, in its two parts."""
    wrong, _, remedy = message.removeprefix("Value error, ").partition(": ")
    return wrong, remedy or "docs/scene-reference.md describes every setting"


def reason(detail: Any, unit: str = "") -> tuple[str, str]:
    """The same of any error of pydantic's, as far as its kind alone tells; `unit` as it follows a number."""
    context, shown = detail.get("ctx", {}), shown_as(detail["input"])
    if detail["type"] in BOUNDS:
        words, key = BOUNDS[detail["type"]]
        bound = f"{words} {context[key]:g}{unit}"
        return f"must be {bound}{shown}", f"give a number {bound}"
    if detail["type"] == "literal_error":
        allowed = context["expected"].replace("'", "").replace(" or ", ", ").split(", ")
        return f"must be {context['expected']}{shown}", suggestion(str(detail["input"]), allowed)
    if detail["type"] == "quantity":
        return detail["msg"], context.get("remedy") or "give a plain number, or a quantity in a unit of that kind"
    if detail["type"] in KINDS:
        message, remedy = KINDS[detail["type"]]
        return f"{message}{unit}{shown}", f"{remedy}{unit}"
    message, remedy = said(detail["msg"])
    return message, context.get("remedy") or remedy
