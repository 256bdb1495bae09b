"""Rubber: a soft gloss, and a surface that is a little uneven from the mould."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba

GRAIN = 0.006
"""Size of the unevenness over the body's diagonal, unless set."""
POLYISOPRENE = 1.52
"""Index of refraction."""


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    grain = look.grain or GRAIN * size
    uneven = graph.node("TexNoise", {"Vector": graph.place(), "Scale": 1 / grain, "Detail": 2.0}).outputs[0]
    bump = graph.node("Bump", {"Strength": 0.25, "Distance": 0.1 * grain, "Height": uneven}).outputs[0]
    inputs = {"Base Color": rgba(look.color), "Roughness": look.roughness, "IOR": POLYISOPRENE, "Normal": bump}
    inputs |= {"Sheen Weight": 0.05, "Sheen Roughness": 0.5}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
