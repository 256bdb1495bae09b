"""Plastic: a colour under a clear coat."""

from __future__ import annotations

from typing import Any

from render.nodes import Graph, rgba


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    inputs = {"Base Color": rgba(look.color), "Roughness": look.roughness, "Coat Weight": 0.25, "Coat Roughness": 0.08}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
