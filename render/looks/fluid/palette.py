"""A colour for each fluid body and emitter: where their fluids mix, so do the colours, as light does."""

from __future__ import annotations

from typing import Any

from common.attributes import SHARE
from render.content.nodes import Graph, rgba


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    mixed: Any = (0.0, 0.0, 0.0)
    for source, color in vars(look.colors).items():
        share = graph.node("Attribute", attribute_name=f"{SHARE}{source}").outputs[2]
        terms = {0: share, 1: rgba(color)[:3], 2: mixed}
        mixed = graph.node("VectorMath", terms, operation="MULTIPLY_ADD").outputs[0]
    inputs = {"Base Color": mixed, "Roughness": look.roughness, "Specular IOR Level": 0.5}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
