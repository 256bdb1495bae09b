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
    coefficients = absorption(look.color, look.clarity or CLARITY * size)
    strongest = max(coefficients)
    white = (1.0, 1.0, 1.0, 1.0)
    if strongest == 0:
        return clear(graph, white, look.roughness, look.ior), None
    # Blender absorbs density * (1 - colour) per metre
    tint = (*(1 - coefficient / strongest for coefficient in coefficients), 1.0)
    surface, density = white, strongest
    if graph.caustics is not None:
        surface, diffuse = _absorbed_on_the_way(graph, coefficients)
        density = graph.math("MULTIPLY_ADD", diffuse, -strongest, strongest)
    volume = graph.node("VolumeAbsorption", {"Color": tint, "Density": density}).outputs[0]
    return clear(graph, surface, look.roughness, look.ior), volume


def _absorbed_on_the_way(graph: Graph, coefficients: tuple[float, ...]) -> tuple[Any, Any]:
    """What is left of light on the way from what it falls on to the surface, and whether the ray is such a one: Cycles
    asks a surface for it as of a diffuse ray, and no volume."""
    path, inside = graph.node("LightPath").outputs, graph.node("NewGeometry").outputs["Backfacing"]
    way = graph.math("MULTIPLY", graph.math("MULTIPLY", path["Ray Length"], inside), path["Is Diffuse Ray"])
    left = (graph.math("POWER", math.exp(-coefficient), way) for coefficient in coefficients)
    return graph.node("CombineColor", dict(enumerate(left))).outputs[0], path["Is Diffuse Ray"]
