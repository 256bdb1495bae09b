"""Quantities: a unit of the same kind is converted, everything else is refused."""

from __future__ import annotations

import math

import pytest
from pydantic_core import PydanticCustomError

from sim.units import Unit

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
]


@pytest.mark.parametrize(("unit", "text", "value"), GOOD)
def test_a_quantity(unit, text, value):
    assert Unit(unit).convert(text) == pytest.approx(value, rel=1e-14)


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


@pytest.mark.parametrize(("unit", "text"), BAD)
def test_no_quantity(unit, text):
    with pytest.raises(PydanticCustomError):
        Unit(unit).convert(text)
