"""Woven cloth: soft, with a sheen, letting some light through."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    color = rgba(look.color)
    inputs = {
        "Base Color": color,
        "Roughness": 0.9,
        "Specular IOR Level": 0.1,
        "Sheen Weight": look.sheen,
        "Sheen Roughness": look.roughness,
    }
    weave = graph.node("BsdfPrincipled", inputs).outputs[0]
    backlit = graph.node("BsdfTranslucent", {"Color": color}).outputs[0]
    return graph.mix(look.translucency, weave, backlit), None
