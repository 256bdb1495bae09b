"""Plastic: a colour under a clear coat."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    color = graph.tint() if look.color is None else rgba(look.color)
    inputs = {"Base Color": color, "Roughness": look.roughness, "Coat Weight": 0.25, "Coat Roughness": 0.08}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
