"""Colours of the settings, as a colour picker shows them (sRGB)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any

from annotated_types import Ge, Le
from pydantic_core import PydanticCustomError, core_schema

from scene.notation import unquoted

_HEX = re.compile(r"#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})")


@dataclass(frozen=True)
class HexColor:
    """Annotation of a colour field: `#rrggbb` and `#rgb` become three numbers from 0 to 1."""

    def convert(self, value: Any) -> Any:
        """Red, green and blue from 0 to 1; lists of such numbers stay as they are. Raises PydanticCustomError for what
        is no colour."""
        in_bytes = _in_bytes(value)
        if isinstance(value, list | tuple) and not in_bytes:
            return value
        match = _HEX.fullmatch(value.strip()) if isinstance(value, str) else None
        if match is None:
            raise PydanticCustomError(
                "color",
                "expected a colour such as '#3a7bd5' or [0.2, 0.5, 0.8], got '{text}'",
                {"text": str(value)[:80], "remedy": in_bytes or _meant(value)},
            )
        digits = match[1] if len(match[1]) == 6 else "".join(2 * digit for digit in match[1])
        return tuple(round(int(digits[start : start + 2], 16) / 255, 6) for start in (0, 2, 4))

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_before_validator_function(self.convert, handler(source))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [handler(schema), {"type": "string", "pattern": f"^{_HEX.pattern}$"}]}


def _in_bytes(value: Any) -> str:
    """What to write for numbers from 0 to 255; empty for any others."""
    whole = isinstance(value, list | tuple) and len(value) == 3 and all(type(channel) is int for channel in value)
    if not whole or max(value) <= 1 or min(value) < 0 or max(value) > 255:
        return ""
    return "write '#{:02x}{:02x}{:02x}', or numbers from 0 to 1".format(*value)


def _meant(value: Any) -> str:
    """What to write for a name, for digits without `#`, or with opacity; empty where that is not known."""
    text = unquoted(str(value)).strip()
    if type(value) is int and len(text) <= 6:
        return f"write '#{text:0>6}', in quotes"
    if match := re.fullmatch(r"#?([0-9a-fA-F]{6}|[0-9a-fA-F]{3})([0-9a-fA-F]{2})?", text):
        return f"write '#{match[1]}'" + (": a colour has no opacity" if match[2] else ", in straight quotes")
    try:
        from PIL.ImageColor import getrgb

        return "write '#{:02x}{:02x}{:02x}'".format(*getrgb(text)[:3])
    except (ImportError, ValueError):
        return ""


Channel = Annotated[float, Ge(0), Le(1)]
Color = Annotated[tuple[Channel, Channel, Channel], HexColor()]
"""Red, green and blue from 0 to 1, or a string such as `#3a7bd5`; sRGB, as colour pickers show it."""


def srgb(code: str) -> tuple[float, float, float]:
    """The colour of a `#rrggbb` string, for defaults."""
    return HexColor().convert(code)
