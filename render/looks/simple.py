"""What looks become in files for other programs: one Principled BSDF each, which USD and glTF know.

Of a look without a line here, files have the first Principled BSDF that it is made with.
"""

from __future__ import annotations

from typing import Any, Literal

from render.content.nodes import Graph, rgba
from render.looks import Build, load_look
from render.looks.fluid.colormap import MAPS
from render.looks.fluid.water import CLARITY

Known = Literal["all", "transmission", "opacity"]
"""What a format knows of clear things: `all` is Blender itself, which needs no other looks."""

VEIL = 0.2
"""Opacity of what is clear, where a format knows no transmission: less, and nothing would be seen of still water;
more, and nothing of what is under it."""


def load_simple(look: Any, known: Known) -> Build:
    """What builds a look for a format; raises Unusable as `load_look` does."""
    if known == "all" or look.type not in SIMPLE:
        return load_look(look)
    build = SIMPLE[look.type]
    return lambda graph, look, size: build(graph, look, size, known == "transmission")


def _water(graph: Graph, look: Any, size: float, transmits: bool) -> tuple[Any, Any]:
    if not transmits:
        return _clear(graph, look, transmits), None
    clarity = look.clarity or CLARITY * size
    tint = graph.node("VolumeAbsorption", {"Color": rgba(look.color), "Density": 1 / clarity}).outputs[0]
    return _clear(graph, look, transmits, (1.0, 1.0, 1.0, 1.0)), tint


def _glass(graph: Graph, look: Any, size: float, transmits: bool) -> tuple[Any, Any]:
    return _clear(graph, look, transmits), None


def _clear(graph: Graph, look: Any, transmits: bool, color: tuple[float, ...] | None = None) -> Any:
    inputs = {"Base Color": color or rgba(look.color), "Roughness": look.roughness, "IOR": look.ior}
    # Blender writes as opacity what is set as Alpha until 5.0, then what is not transmitted
    inputs |= {"Transmission Weight": 1.0} if transmits else {"Alpha": VEIL, "Transmission Weight": 1 - VEIL}
    return graph.node("BsdfPrincipled", inputs).outputs[0]


def _matte(graph: Graph, look: Any, size: float, transmits: bool) -> tuple[Any, Any]:
    inputs = {"Base Color": rgba(look.color), "Roughness": 1.0, "Specular IOR Level": 0.0}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None


def _even(graph: Graph, look: Any, size: float, transmits: bool) -> tuple[Any, Any]:
    inputs = {"Base Color": rgba(look.color), "Roughness": look.roughness}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None


def _cloth(graph: Graph, look: Any, size: float, transmits: bool) -> tuple[Any, Any]:
    inputs = {"Base Color": rgba(look.color), "Roughness": 0.9, "Specular IOR Level": 0.1}
    inputs |= {"Sheen Weight": look.sheen, "Sheen Roughness": look.roughness}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None


def _colormap(graph: Graph, look: Any, size: float, transmits: bool) -> tuple[Any, Any]:
    middle = MAPS[look.map][len(MAPS[look.map]) // 2]
    color = rgba([int(middle[at : at + 2], 16) / 255 for at in (0, 2, 4)])
    return graph.node("BsdfPrincipled", {"Base Color": color, "Roughness": look.roughness}).outputs[0], None


def _palette(graph: Graph, look: Any, size: float, transmits: bool) -> tuple[Any, Any]:
    colors = [rgba(color) for color in vars(look.colors).values()]
    mean = tuple(sum(channel) / len(colors) for channel in zip(*colors, strict=True))
    return graph.node("BsdfPrincipled", {"Base Color": mean, "Roughness": look.roughness}).outputs[0], None


PATTERNED = ("stone", "wood", "paper", "ceramic", "lemon", "planks", "tiles")
"""Looks that have the one colour of their settings in files: Blender's exporters leave out colours that nodes make."""
SIMPLE = dict.fromkeys(PATTERNED, _even) | {
    "water": _water,
    "glass": _glass,
    "matte": _matte,
    "cloth": _cloth,
    "colormap": _colormap,
    "palette": _palette,
}
"""By the type that they have in a scene."""
