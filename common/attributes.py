"""What the surface of water may say of the fluid at its vertices."""

from __future__ import annotations

from typing import Literal, get_args

Attribute = Literal["speed", "vorticity", "density"]
ATTRIBUTES: tuple[Attribute, ...] = get_args(Attribute)
UNITS: dict[Attribute, str] = {"speed": "m/s", "vorticity": "s^-1", "density": "kg/m^3"}

WET = "wet"
"""Of cloth as drawn: how wet it is, from 0 to 1."""
FOAM = "foam"
"""Of the surface as drawn: cross-section of the foam that lies on it over its area [1]."""
