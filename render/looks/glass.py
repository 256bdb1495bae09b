"""Clear or frosted glass."""

from __future__ import annotations

from typing import Any

from render.looks.refraction import clear
from render.nodes import Graph, rgba


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    return clear(graph, rgba(look.color), look.roughness, look.ior), None
