"""What things are made of: one file a look, and this registry.

A look is a function `build(graph, look, size)`: it adds nodes to the graph, from its settings and
the diagonal [m] of what it covers, and returns the shader of the surface and that of the volume or None.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from common.registry import load
from render.errors import Unusable

Build = Callable[[Any, Any, float], tuple[Any, Any]]

LOOKS = {
    "water": "render.looks.fluid.water:build",
    "plastic": "render.looks.plastic:build",
    "metal": "render.looks.metal:build",
    "stone": "render.looks.patterned.stone:build",
    "matte": "render.looks.matte:build",
    "cloth": "render.looks.cloth:build",
    "glass": "render.looks.glass:build",
    "wood": "render.looks.patterned.wood:build",
    "rubber": "render.looks.rubber:build",
    "paper": "render.looks.patterned.paper:build",
    "ceramic": "render.looks.patterned.ceramic:build",
    "lemon": "render.looks.patterned.lemon:build",
    "planks": "render.looks.patterned.planks:build",
    "tiles": "render.looks.patterned.tiles:build",
    "colormap": "render.looks.fluid.colormap:build",
    "palette": "render.looks.fluid.palette:build",
    "imported": "render.looks.imported:build",
}
"""By the type that they have in a scene."""


def load_look(look: Any) -> Build:
    """What builds a look; settings of one that an installed package adds say it themselves, in `build`.

    Raises Unusable where that cannot be imported by the Python of this Blender.
    """
    try:
        return load(getattr(look, "build", None) or LOOKS[look.type])
    except ImportError as error:
        raise Unusable(
            f"the look `type: {look.type}` cannot be built in this Blender: {error}\n"
            "  fix: let what builds it import bpy and the standard library alone, or render with the package bpy, "
            "without --blender or TIDEMILL_BLENDER"
        ) from None
