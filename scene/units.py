"""Quantities of the settings: a number in the SI unit, or a string with any unit of that kind.

`particle_radius: 0.01`, `particle_radius: 10 mm` and `particle_radius: 1 cm` are the same
setting; `particle_radius: 10 s` is refused.
"""

from __future__ import annotations

import contextlib
import functools
import re
import sys
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any

from annotated_types import Ge, Gt, Le
from pydantic_core import PydanticCustomError, core_schema

from scene.notation import meant, plain

if TYPE_CHECKING:
    import pint


@functools.cache
def _registry():
    import pint

    return pint.UnitRegistry(cache_folder=None)


COMMON = {("mm", "m"): 1e-3, ("cm", "m"): 1e-2, ("ms", "s"): 1e-3, ("g", "kg"): 1e-3}
"""Units of most scenes, with what they are of another: pint, which knows all, takes a quarter of a second to load."""

_FACTOR = r"[A-Za-zµμ°]+(?:(?:\^|\*\*)?-?\d)?"
# Only a number and a product of units: pint itself would also compute `9**9**9**9`.
_QUANTITY = re.compile(
    rf"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*"
    rf"((?:1?\s*/\s*)?{_FACTOR}(?:(?:\s*[*/·]\s*|\s+){_FACTOR})*)?\s*",
    re.ASCII,
)
_BARE_POWER = re.compile(r"(?<=[A-Za-zµμ°])-?\d")
"""Of units as they are often typed: `kg/m3`, `m s-2`."""


def _match(text: str) -> re.Match[str] | None:
    """The number and the unit, or None, of a text that is a quantity."""
    return _QUANTITY.fullmatch(plain(text))


def _units(text: str) -> str:
    return "1" + text if text.startswith("/") else _BARE_POWER.sub(r"^\g<0>", text)


def _quantity(text: str) -> pint.Quantity:
    """The number and unit of a text; raises ValueError where it holds anything else."""
    found = _match(text)
    if found is None:
        raise ValueError(text)
    number, unit = found.groups()
    return _registry().Quantity(float(number), _units(unit or ""))


def _same_kind(given: str, wanted: str) -> bool:
    """What dimensions do not tell: angles and turns are not plain numbers, and 1 Hz is not 1 rad/s."""
    angular = any(word in given for word in ("radian", "degree", "revolution", "turn"))
    if wanted == "1":
        return not angular
    return given != "dimensionless" and angular == (wanted in {"deg", "rad/s"})


def _of_another_kind(number: float, unit: str, wanted: str) -> str:
    """What to write for a number with a unit that is often taken for the one that is wanted."""
    match wanted, unit:
        case "m/s^2", "g" | "G":
            return f"g is the gram: write {9.81 * number:g}"
        case "kg", "N":
            return f"a mass is meant, not a weight: write {number / 9.81:.4g} kg"
        case "rad/s", _:
            return "write it in rad/s, deg/s or rpm"
        case "Hz", "fps":
            return f"write {number:g}"
        case "m^2/s", _:
            with contextlib.suppress(Exception):
                kinematic = _registry().Quantity(number, _units(unit)).to("Pa*s").magnitude / 1000
                return (
                    "the kinematic viscosity is meant, which is this one over the density: "
                    f"write {kinematic:.4g} for a liquid of 1000 kg/m^3"
                )
        case "1", _:
            return "give a plain number, without a unit"
    return ""


@dataclass(frozen=True)
class Unit:
    """Annotation of a float field: its unit, and the conversion of strings into it."""

    symbol: str

    def convert(self, value: Any) -> Any:
        """The number in the field's unit that a string means; what is no string stays as it is. Raises
        PydanticCustomError for what means no quantity of that kind, or is not finite."""
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
        try:
            converted = self._by_table(text)
            if converted is None:
                quantity = _quantity(text)
                if not _same_kind(str(quantity.units), self.symbol):
                    raise ValueError(text)
                converted = quantity.to(self.symbol).magnitude
            # 35 times 0.001 is not 0.035: the digits that were typed decide.
            return float(f"{converted:.15g}")
        except Exception as error:  # pint lets errors of every kind through
            example = "" if self.symbol == "1" else f", or a quantity such as '2 {self.symbol}'"
            raise PydanticCustomError(
                "quantity",
                "expected {number}{example}, got '{text}'",
                {"number": self._number(), "example": example, "text": text[:80], "remedy": self._meant(text)},
            ) from error

    def _by_table(self, text: str) -> float | None:
        """The number in the field's unit, where it is given in that one or in a common one, before it is rounded."""
        found = _match(text)
        if found is None or found[2] is None:
            return None
        factor = 1.0 if found[2] == self.symbol else COMMON.get((found[2], self.symbol))
        return None if factor is None else float(found[1]) * factor

    def _meant(self, text: str) -> str:
        """What to write instead; empty where that is not known."""
        if self.symbol == "1" and (percent := re.fullmatch(r"\s*([\d.]+)\s*%\s*", text)):
            return f"write {float(percent[1]) / 100:g}"
        match = _match(text)
        if match is None or not match[2]:
            return meant(text)
        number, unit = match.groups()
        for spelling in (unit.lower(), unit[:1].lower() + unit[1:]):
            if spelling != unit and self._reads(f"1 {spelling}"):
                return f"write {number} {spelling}"
        return _of_another_kind(float(number), unit, self.symbol)

    def _reads(self, text: str) -> bool:
        try:
            quantity = _quantity(text)
            return _same_kind(str(quantity.units), self.symbol) and quantity.check(_quantity(f"1 {self.symbol}").units)
        except Exception:  # pint lets errors of every kind through
            return False

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_before_validator_function(self.convert, handler(source))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        number = _tightest(handler(schema))
        quantity = {"type": "string", "pattern": r"^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*[A-Za-zµ°]"}
        return {"anyOf": [number] if self.symbol == "1" else [number, quantity], "unit": self.symbol}


_RATIO = re.compile(r"\s*(\d{1,9})\s*/\s*(\d{1,9})\s*(?:Hz|fps)?\s*", re.ASCII)


@dataclass(frozen=True)
class Rate(Unit):
    """Annotation of a rate of frames: a ratio of whole numbers, too, as `24000/1001`, of which the nearest float is
    taken; `as_ratio` knows it again."""

    symbol: str = "Hz"

    def _parse(self, text: str) -> float:
        found = _RATIO.fullmatch(plain(text))
        if found is None or int(found[2]) == 0:
            return super()._parse(text)
        return int(found[1]) / int(found[2])

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        known = super().__get_pydantic_json_schema__(schema, handler)
        ratio = {"type": "string", "pattern": r"^\s*\d+\s*/\s*\d+\s*$"}
        return {**known, "anyOf": [*known["anyOf"], ratio]}


LARGEST_DENOMINATOR = 1001
"""Of television: 24000/1001, 30000/1001, 60000/1001."""


def as_ratio(rate: float) -> Fraction | None:
    """The ratio of small whole numbers that a rate is the nearest float of; None where it is none."""
    ratio = Fraction(rate).limit_denominator(LARGEST_DENOMINATOR)
    return ratio if float(ratio) == rate else None


def _tightest(number: dict[str, Any]) -> dict[str, Any]:
    """The schema of a float with one lower and one upper bound: pydantic adds further ones beside the first."""
    lower = [(number[key], key in {"gt", "exclusiveMinimum"}) for key in _LOWER if key in number]
    upper = [(number[key], key not in {"lt", "exclusiveMaximum"}) for key in _UPPER if key in number]
    bounds = {}
    if lower:
        value, exclusive = max(lower)
        bounds["exclusiveMinimum" if exclusive else "minimum"] = value
    if upper:
        value, inclusive = min(upper)
        bounds["maximum" if inclusive else "exclusiveMaximum"] = value
    return {key: value for key, value in number.items() if key not in {*_LOWER, *_UPPER}} | bounds


_LOWER = ("ge", "gt", "minimum", "exclusiveMinimum")
_UPPER = ("le", "lt", "maximum", "exclusiveMaximum")

Dimensionless = Annotated[float, Ge(-1e9), Le(1e9), Unit("1")]
Length = Annotated[float, Ge(-1e6), Le(1e6), Unit("m")]
PositiveLength = Annotated[float, Ge(1e-6), Le(1e6), Unit("m")]
Duration = Annotated[float, Ge(0), Le(1e6), Unit("s")]
PositiveDuration = Annotated[float, Gt(0), Le(1e6), Unit("s")]
Frequency = Annotated[float, Gt(0), Le(1e9), Unit("Hz")]
FrameRate = Annotated[float, Gt(0), Le(1e9), Rate()]
Speed = Annotated[float, Ge(-1e5), Le(1e5), Unit("m/s")]
PositiveSpeed = Annotated[float, Gt(0), Le(1e7), Unit("m/s")]
Acceleration = Annotated[float, Ge(-1e6), Le(1e6), Unit("m/s^2")]
StrainRate = Annotated[float, Ge(-1e6), Le(1e6), Unit("s^-1")]
AngularSpeed = Annotated[float, Ge(-1e6), Le(1e6), Unit("rad/s")]
Angle = Annotated[float, Ge(-1e6), Le(1e6), Unit("deg")]
Density = Annotated[float, Ge(1e-3), Le(1e6), Unit("kg/m^3")]
Mass = Annotated[float, Ge(1e-15), Le(1e15), Unit("kg")]
AreaDensity = Annotated[float, Ge(1e-6), Le(1e6), Unit("kg/m^2")]
KinematicViscosity = Annotated[float, Ge(0), Le(1e6), Unit("m^2/s")]
SurfaceTension = Annotated[float, Ge(0), Le(1e6), Unit("N/m")]
ForceComponent = Annotated[float, Ge(-1e15), Le(1e15), Unit("N")]
TorqueComponent = Annotated[float, Ge(-1e15), Le(1e15), Unit("N*m")]
VolumeRate = Annotated[float, Gt(0), Le(1e9), Unit("m^3/s")]
"""The bounds are far from every film; within them no product of a few settings overflows."""

Position = tuple[Length, Length, Length]
Extents = tuple[PositiveLength, PositiveLength, PositiveLength]
Velocity = tuple[Speed, Speed, Speed]
AngularVelocity = tuple[AngularSpeed, AngularSpeed, AngularSpeed]
VelocityGradient = tuple[
    tuple[StrainRate, StrainRate, StrainRate],
    tuple[StrainRate, StrainRate, StrainRate],
    tuple[StrainRate, StrainRate, StrainRate],
]
Force = tuple[ForceComponent, ForceComponent, ForceComponent]
Torque = tuple[TorqueComponent, TorqueComponent, TorqueComponent]
Direction = tuple[Dimensionless, Dimensionless, Dimensionless]
