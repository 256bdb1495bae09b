"""Bare metal."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    inputs = {"Base Color": rgba(look.color), "Metallic": 1.0, "Roughness": look.roughness}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
