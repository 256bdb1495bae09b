"""What the surface of water may say of the fluid at its vertices."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal

Attribute = Literal["speed", "vorticity", "density", "age", "source"]
Number = Literal["speed", "vorticity", "density", "age"]
UNITS: dict[Number, str] = {"speed": "m/s", "vorticity": "s^-1", "density": "kg/m^3", "age": "s"}
"""Of those that are one number."""
SHARE = "source_"
"""How the columns of `source` begin: one for each fluid body and emitter, as `source_tap`, its share of the fluid."""
WET = "wet"
"""Of cloth as drawn: how wet it is, from 0 to 1."""
FOAM = "foam"
"""Of the surface as drawn: cross-section of the foam that lies on it over its area [1]."""


def columns_of(names: Iterable[Attribute], sources: Iterable[str]) -> Iterator[str]:
    """The columns that vertices have for attributes, in their order, where fluid comes from `sources`."""
    for name in names:
        if name == "source":
            yield from (f"{SHARE}{source}" for source in sources)
        else:
            yield name


def attributes_among(columns: Iterable[str]) -> list[str]:
    """Those of some columns that say something of the fluid."""
    return [name for name in columns if name in UNITS or name.startswith(SHARE)]
