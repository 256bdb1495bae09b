"""False colours: what the surface of water says of the fluid, by a map of colours."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba

MAPS = {
    "viridis": ("440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"),
    "inferno": ("000004", "210c4a", "57106e", "8a226a", "bc3754", "e45a31", "f98e09", "f9cb35", "fcffa4"),
    "coolwarm": ("3b4cc0", "6282ea", "8db0fe", "b9d0f9", "dddcdc", "f5c4ac", "f4987a", "dd5f4b", "b40426"),
}
"""Colours (sRGB) at even distances, the lowest first, as Matplotlib has them."""


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    value = graph.node("Attribute", attribute_name=look.attribute).outputs[2]
    share = graph.node("MapRange", {"Value": value, "From Min": look.low, "From Max": look.high}).outputs[0]
    stops = [rgba([int(color[at : at + 2], 16) / 255 for at in (0, 2, 4)]) for color in MAPS[look.map]]
    inputs = {"Base Color": graph.color_ramp(share, stops), "Roughness": look.roughness, "Specular IOR Level": 0.3}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
