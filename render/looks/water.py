"""Water: refraction at the surface, absorption inside (Beer-Lambert)."""

from __future__ import annotations

import math
from typing import Any

from render.content.nodes import Graph, rgba
from render.looks.refraction import clear

CLARITY = 0.4
"""Of the action's diagonal: the way after which white light has the water's colour, unless set."""
DARKEST = 1e-3
"""Least share of light that is left after that way: black would need infinite absorption."""


def absorption(color: tuple[float, float, float], clarity: float) -> tuple[float, ...]:
    """Coefficients [1/m] that leave `color` (sRGB) of white light after `clarity` metres."""
    return tuple(-math.log(max(channel, DARKEST)) / clarity for channel in rgba(color)[:3])


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    surface = clear(graph, (1.0, 1.0, 1.0, 1.0), look.roughness, look.ior)
    coefficients = absorption(look.color, look.clarity or CLARITY * size)
    strongest = max(coefficients)
    if strongest == 0:
        return surface, None
    # Blender absorbs density * (1 - colour) per metre
    tint = (*(1 - coefficient / strongest for coefficient in coefficients), 1.0)
    return surface, graph.node("VolumeAbsorption", {"Color": tint, "Density": strongest}).outputs[0]
