"""Paper: fibres that lie in clouds, and some light that comes through."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba
from render.looks.translucency import lit_through

GRAIN = 0.02
"""Size of the clouds of fibres over the diagonal, unless set."""
CELLULOSE = 1.53
"""Index of refraction."""


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    per_cloud = 1 / (look.grain or GRAIN * size)
    clouds = graph.node("TexNoise", {"Vector": graph.place(), "Scale": per_cloud, "Detail": 3.0}).outputs[0]
    fibres = graph.node("TexNoise", {"Vector": graph.place(), "Scale": 8 * per_cloud, "Detail": 4.0}).outputs[0]
    red, green, blue, _ = rgba(look.color)
    thick = (0.93 * red, 0.92 * green, 0.9 * blue, 1.0)
    shade = graph.math("ADD", graph.math("MULTIPLY", clouds, 0.6), graph.math("MULTIPLY", fibres, 0.4))
    color = graph.mix_colors(graph.ramp(shade, 0.3, 0.7), (red, green, blue, 1.0), thick)
    bump = graph.node("Bump", {"Strength": 0.3, "Distance": 0.02 / per_cloud, "Height": fibres}).outputs[0]
    inputs = {"Base Color": color, "Roughness": look.roughness, "IOR": CELLULOSE, "Normal": bump}
    sheet = graph.node("BsdfPrincipled", inputs).outputs[0]
    return lit_through(graph, look.translucency, sheet, color), None
