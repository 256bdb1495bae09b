"""What the surface of water may say of the fluid at its vertices."""

from __future__ import annotations

from typing import Literal, get_args

Attribute = Literal["speed", "vorticity", "density"]
ATTRIBUTES: tuple[Attribute, ...] = get_args(Attribute)
UNITS: dict[Attribute, str] = {"speed": "m/s", "vorticity": "s^-1", "density": "kg/m^3"}
