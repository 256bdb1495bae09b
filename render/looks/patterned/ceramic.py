"""Glazed ceramic: a dull body, specks of iron in it, and a layer of glass on top that is not quite even."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba

GRAIN = 0.012
"""Distance of the specks over the body's diagonal, unless set."""
WAVE = 0.2
"""Length of the unevenness of the glaze over the body's diagonal."""
GLAZE = 1.5
"""Index of refraction: a glass."""


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    color = rgba(look.color)
    if look.specks > 0:
        cells = graph.node("TexVoronoi", {"Vector": graph.place(), "Scale": 1 / (look.grain or GRAIN * size)})
        chance = graph.node("SeparateXYZ", {0: cells.outputs["Color"]})
        # each cell has a speck or none, of its own size
        radius = graph.math("MULTIPLY_ADD", chance.outputs["Y"], 0.2, 0.1)
        near = graph.math("LESS_THAN", cells.outputs["Distance"], radius)
        speck = graph.math("MULTIPLY", near, graph.math("LESS_THAN", chance.outputs["X"], look.specks))
        iron = tuple(0.25 * channel * share for channel, share in zip(color, (1.0, 0.6, 0.35), strict=False))
        color = graph.mix_colors(speck, color, (*iron, 1.0))
    waves = graph.node("TexNoise", {"Vector": graph.place(), "Scale": 1 / (WAVE * size), "Detail": 1.0}).outputs[0]
    bump = graph.node("Bump", {"Strength": 0.2, "Distance": 0.02 * size, "Height": waves}).outputs[0]
    inputs = {"Base Color": color, "Roughness": 0.5, "Coat Weight": 1.0, "Coat IOR": GLAZE}
    inputs |= {"Coat Roughness": look.roughness, "Coat Normal": bump}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
