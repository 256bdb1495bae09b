"""Quantities of the settings: a number in the SI unit, or a string with any unit of that kind.

`particle_radius: 0.01`, `particle_radius: 10 mm` and `particle_radius: 1 cm` are the same
setting; `particle_radius: 10 s` is refused.
"""

from __future__ import annotations

import functools
import sys
from dataclasses import dataclass
from typing import Annotated, Any

from annotated_types import Ge, Gt
from pydantic_core import PydanticCustomError, core_schema


@functools.cache
def _registry():
    import pint

    return pint.UnitRegistry(cache_folder=None)


@dataclass(frozen=True)
class Unit:
    """Annotation of a float field: its unit, and the conversion of strings into it."""

    symbol: str

    def convert(self, value: Any) -> Any:
        if isinstance(value, bool) or value is None:
            shown = "nothing" if value is None else str(value).lower()
            raise PydanticCustomError(
                "quantity", "expected {number}, got {value}", {"number": self._number(), "value": shown}
            )
        if isinstance(value, str):
            value = self._parse(value)
        # A comparison, since math.isfinite fails for integers that no float can hold.
        if isinstance(value, int | float) and not abs(value) <= sys.float_info.max:
            raise PydanticCustomError("quantity", "expected {number} that is finite", {"number": self._number()})
        return value

    def _number(self) -> str:
        return "a plain number" if self.symbol == "1" else f"a number in {self.symbol}"

    def _parse(self, text: str) -> float:
        import pint

        registry = _registry()
        try:
            quantity = registry.Quantity(text)
            if quantity.dimensionless and self.symbol != "1" and not quantity.units.dimensionality:
                angle_given = self.symbol == "deg" and str(quantity.units) in {"radian", "degree"}
                if not angle_given:
                    raise pint.DimensionalityError(text, self.symbol)
            return float(quantity.to(self.symbol).magnitude)
        except Exception as error:  # pint's parser lets errors of every kind through
            example = "" if self.symbol == "1" else f", or a quantity such as '2 {self.symbol}'"
            raise PydanticCustomError(
                "quantity",
                "expected {number}{example}, got '{text}'",
                {"number": self._number(), "example": example, "text": text[:80]},
            ) from error

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_before_validator_function(self.convert, handler(source))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        number = handler(schema)
        quantity = {"type": "string", "pattern": r"^\s*[-+0-9.].*[A-Za-z]"}
        return {"anyOf": [number, quantity], "unit": self.symbol}


Dimensionless = Annotated[float, Unit("1")]
Length = Annotated[float, Unit("m")]
PositiveLength = Annotated[float, Gt(0), Unit("m")]
Duration = Annotated[float, Ge(0), Unit("s")]
PositiveDuration = Annotated[float, Gt(0), Unit("s")]
Frequency = Annotated[float, Gt(0), Unit("Hz")]
Speed = Annotated[float, Unit("m/s")]
PositiveSpeed = Annotated[float, Gt(0), Unit("m/s")]
Acceleration = Annotated[float, Unit("m/s^2")]
AngularSpeed = Annotated[float, Unit("rad/s")]
Angle = Annotated[float, Unit("deg")]
Density = Annotated[float, Gt(0), Unit("kg/m^3")]
Mass = Annotated[float, Gt(0), Unit("kg")]
AreaDensity = Annotated[float, Gt(0), Unit("kg/m^2")]
KinematicViscosity = Annotated[float, Ge(0), Unit("m^2/s")]
SurfaceTension = Annotated[float, Ge(0), Unit("N/m")]

Position = tuple[Length, Length, Length]
Extents = tuple[PositiveLength, PositiveLength, PositiveLength]
Velocity = tuple[Speed, Speed, Speed]
AngularVelocity = tuple[AngularSpeed, AngularSpeed, AngularSpeed]
Direction = tuple[Dimensionless, Dimensionless, Dimensionless]
