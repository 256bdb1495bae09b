"""Stone: stains, grains and a rough surface from noise that moves with the body."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba

STAINS = 0.2
"""Size of a stain over the body's diagonal, unless set."""


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    per_metre = 1 / (look.grain or STAINS * size)
    place = graph.place()
    stains = graph.node("TexNoise", {"Vector": place, "Scale": per_metre, "Detail": 6.0}).outputs[0]
    grains = graph.node("TexNoise", {"Vector": place, "Scale": 10 * per_metre, "Detail": 8.0}).outputs[0]
    red, green, blue, _ = rgba(look.color)
    dark, light = ((red * k, green * k, blue * k, 1.0) for k in (0.45, 1.35))
    speckled = graph.math("ADD", graph.math("MULTIPLY", stains, 0.6), graph.math("MULTIPLY", grains, 0.4))
    color = graph.mix_colors(graph.ramp(speckled, 0.32, 0.68), dark, light)
    bump = graph.node("Bump", {"Strength": 0.5, "Distance": 0.02 / per_metre, "Height": grains}).outputs[0]
    inputs = {"Base Color": color, "Roughness": look.roughness, "Normal": bump}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
