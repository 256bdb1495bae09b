"""Colours of the settings, as a colour picker shows them (sRGB)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any

from annotated_types import Ge, Le
from pydantic_core import PydanticCustomError, core_schema

_HEX = re.compile(r"#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})")


@dataclass(frozen=True)
class HexColor:
    """Annotation of a colour field: `#rrggbb` and `#rgb` become three numbers from 0 to 1."""

    def convert(self, value: Any) -> Any:
        if not isinstance(value, str):
            return value
        match = _HEX.fullmatch(value.strip())
        if match is None:
            raise PydanticCustomError(
                "color", "expected a colour such as '#3a7bd5' or [0.2, 0.5, 0.8], got '{text}'", {"text": value}
            )
        digits = match[1] if len(match[1]) == 6 else "".join(2 * digit for digit in match[1])
        return tuple(round(int(digits[start : start + 2], 16) / 255, 6) for start in (0, 2, 4))

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_before_validator_function(self.convert, handler(source))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [handler(schema), {"type": "string", "pattern": f"^{_HEX.pattern}$"}]}


Channel = Annotated[float, Ge(0), Le(1)]
Color = Annotated[tuple[Channel, Channel, Channel], HexColor()]
"""Red, green and blue from 0 to 1, or a string such as `#3a7bd5`; sRGB, as colour pickers show it."""


def srgb(code: str) -> tuple[float, float, float]:
    """The colour of a `#rrggbb` string, for defaults."""
    return HexColor().convert(code)
