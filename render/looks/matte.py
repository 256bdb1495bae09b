"""Chalk, paper, clay."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    return graph.node("BsdfDiffuse", {"Color": rgba(look.color), "Roughness": 0.6}).outputs[0], None
