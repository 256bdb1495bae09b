"""Clear or frosted glass, solid or a thin shell."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba
from render.looks.refraction import clear


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    return clear(graph, rgba(look.color), look.roughness, look.ior, look.thin), None
