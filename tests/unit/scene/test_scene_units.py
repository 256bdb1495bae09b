"""Quantities: a unit of the same kind is converted, everything else is refused."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

import pytest
from pydantic_core import PydanticCustomError

from scene import units
from scene.units import COMMON, Unit

GOOD = [
    ("m", "1 ft", 0.3048),
    ("m", " -2.5e-1 cm ", -0.0025),
    ("s", "1.5 minute", 90),
    ("m/s", "36 km/h", 10),
    ("m/s^2", "981 cm/s^2", 9.81),
    ("kg/m^3", "1 g/cm³", 1000),
    ("kg/m^2", "200 g/m**2", 0.2),
    ("m^2/s", "1 cSt", 1e-6),
    ("N*m", "1 mN m", 1e-3),
    ("N/m", "72 mN/m", 0.072),
    ("Hz", "2 kHz", 2000),
    ("rad/s", "30 rpm", math.pi),
    ("rad/s", "180 deg/s", math.pi),
    ("deg", "1 turn", 360),
    ("deg", "45 °", 45),
    ("1", "0.3", 0.3),
    ("kg/m^3", "800 kg/m3", 800),
    ("kg/m^3", "800 kg m-3", 800),
    ("m/s^2", "\N{MINUS SIGN}9.81 m/s2", -9.81),
    ("m/s^2", "9.81 m·s⁻²", 9.81),
    ("m", "5\N{NO-BREAK SPACE}mm", 0.005),
    ("m", "5\N{NARROW NO-BREAK SPACE}mm", 0.005),
    ("deg", "45\N{MASCULINE ORDINAL INDICATOR}", 45),
    ("Hz", "12 1/s", 12),
    ("Hz", "12 /s", 12),
    ("m^3/s", "5 m3/s", 5),
]


@pytest.mark.parametrize(("unit", "text", "value"), GOOD)
def test_a_quantity(unit, text, value):
    assert Unit(unit).convert(text) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(("unit", "symbol"), COMMON)
@pytest.mark.parametrize("number", ["1", "35", "-0.1", "12.7", "3e-3", "123456.789012", "0.0000012345678"])
def test_the_table_of_common_units_says_what_pint_says(unit, symbol, number, monkeypatch):
    text = f"{number} {unit}"
    by_table = Unit(symbol).convert(text)
    monkeypatch.setattr(units, "COMMON", {})
    assert by_table == Unit(symbol).convert(text) == float(Decimal(number) * Decimal(str(COMMON[unit, symbol])))


BAD = [
    ("m", "10 s"),
    ("m", "10"),
    ("m", "m"),
    ("m", ""),
    ("m", "10 furlong_typo"),
    ("m", "1 + 1 m"),
    ("m", "9**9**9**9 m"),
    ("m", "__import__('os').system('true') m"),
    ("m", "1e999 m"),
    ("m", "10 degC"),
    ("m", "1_0 m"),
    ("deg", "30"),
    ("1", "30 deg"),
    ("rad/s", "2 Hz"),
    ("Hz", "30 rpm"),
    ("kg/m^3", "1 kg"),
]


MEANT = [
    ("m", "0,05", "decimals have a point: write 0.05"),
    ("m", "2,5 cm", "write 2.5 cm"),
    ("m", "1,250 mm", "write 1.250 mm, or 1250 mm if thousands were meant"),
    ("1", "1,000,000", "write 1000000 without commas"),
    ("1", "50 %", "write 0.5"),
    ("1", "1/2", "write 0.5"),
    ("1", "3 kg", "give a plain number, without a unit"),
    ("m", "50 %", ""),
    ("m", "\u201c25 mm\u201d", "write 25 mm without these quotes"),
    ("m", '2 "', "write 2 in"),
    ("m", "25 MM", "write 25 mm"),
    ("s", "2 S", "write 2 s"),
    ("m", "0; 1; 2", "part values by commas, as [0, 1, 2]"),
    ("m/s^2", "\N{EN DASH}9.81", "that is a dash: write -9.81"),
    ("m/s^2", "2 g", "g is the gram: write 19.62"),
    ("m^2/s", "5 Pa·s", "the kinematic viscosity is meant, which is this one over the density: write 0.005"),
    ("rad/s", "2 Hz", "write it in rad/s, deg/s or rpm"),
    ("Hz", "12 fps", "write 12"),
    ("kg", "9.81 N", "write 1 kg"),
    ("m", "10 s", ""),
]


@pytest.mark.parametrize(("unit", "text", "remedy"), MEANT)
def test_what_was_meant(unit, text, remedy):
    with pytest.raises(PydanticCustomError) as refused:
        Unit(unit).convert(text)
    found = refused.value.context["remedy"]
    assert remedy in found and bool(remedy) == bool(found)


@pytest.mark.parametrize(("unit", "text"), BAD)
def test_no_quantity(unit, text):
    with pytest.raises(PydanticCustomError):
        Unit(unit).convert(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("24000/1001", 24000 / 1001),
        (" 30000 / 1001 Hz ", 30000 / 1001),
        ("25/1", 25),
        ("12 1/s", 12),
        ("2 kHz", 2000),
        (24, 24),
    ],
)
def test_a_rate_of_frames_may_be_a_ratio(text, value):
    assert units.Rate().convert(text) == value


@pytest.mark.parametrize(
    "text", ["24000/0", "24/1.001", "/1001", "24000/", "24000/1001/2", "24000//1001", "24000/1001 s"]
)
def test_what_is_no_ratio_is_refused(text):
    with pytest.raises(PydanticCustomError):
        units.Rate().convert(text)


@pytest.mark.parametrize("rate", [24, 25, 12.5, 23.976, 29.97, 59.94, 0.5, 24000 / 1001, 30000 / 1001, 120000 / 1001])
def test_the_ratio_of_a_rate_is_known_again(rate):
    ratio = units.as_ratio(rate)
    assert ratio is not None and float(ratio) == rate


def test_a_rate_that_is_no_ratio_of_small_numbers_is_left_alone():
    assert units.as_ratio(math.pi) is None
    assert units.as_ratio(24000 / 1001) == Fraction(24000, 1001)
