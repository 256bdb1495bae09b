"""What things are made of: one file a look, and this registry.

A look is a function `build(graph, look, size)`: it adds nodes to the graph, from its settings and
the diagonal [m] of what it covers, and returns the shader of the surface and that of the volume or None.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from render.content.nodes import Graph
from render.looks import cloth, glass, matte, metal, plastic, stone, water

LOOKS: dict[str, Callable[[Graph, Any, float], tuple[Any, Any]]] = {
    "water": water.build,
    "plastic": plastic.build,
    "metal": metal.build,
    "stone": stone.build,
    "matte": matte.build,
    "cloth": cloth.build,
    "glass": glass.build,
}
