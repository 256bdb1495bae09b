"""Blender materials from the looks of the settings, and looks for what the scene leaves open."""

from __future__ import annotations

import colorsys
import zlib
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from render.blender import versions
from render.blender.session import bpy
from render.content.nodes import Caustics, Graph, rgba
from render.looks.simple import Known, load_simple
from render.looks.wet import moisten, soaked
from render.texturing.nodes import put_images

PALETTE = ((0.82, 0.24, 0.11), (0.95, 0.69, 0.20), (0.16, 0.47, 0.44), (0.36, 0.32, 0.60), (0.79, 0.36, 0.47))
"""Colours (sRGB) of bodies and sheets without a look of their own, in turn."""
Wet = Callable[[Graph], Any]
"""The node output that says how wet a point of a surface is, from 0 to 1."""
HUES = 0.25
"""Share of the circle of hues by which a full variation turns them, either way."""
PLAIN = (0.894118, 0.341176, 0.180392)
"""Colour (sRGB) of what has none of its own, where the look leaves it open."""


def make_material(
    name: str,
    look: Any,
    size: float,
    *,
    tinted: bool = False,
    rests: bool = False,
    thick: bool = False,
    caustics: Caustics | None = None,
    known: Known = "all",
    wet: Wet | None = None,
) -> Any:
    """A Blender material; `size` is the diagonal [m] of what it covers, `tinted` if its vertices have colours, `known`
    what its readers know of clear things. `rests` and `thick` are of sheets, as Graph has them. Without `caustics`
    light passes straight through what is clear. `wet` gives how wet a point is, from 0 to 1."""
    if getattr(look, "color", PLAIN) is None and not tinted:
        look = SimpleNamespace(**vars(look) | {"color": PLAIN})
    look = _varied(look, name)
    material = bpy.data.materials.new(name)
    graph = Graph.new(material, rests, thick, caustics)
    surface, volume = load_simple(look, known)(graph, look, size)
    put_images(graph, name, look)
    for key, value in vars(getattr(look, "principled", SimpleNamespace())).items():
        graph.override(key, rgba(value) if isinstance(value, list) else value)
    if wet is not None and any(soaked(look)):
        surface = moisten(graph, look, wet(graph), surface)
    output = graph.node("OutputMaterial", {"Surface": surface})
    if volume is not None:
        graph.feed(output, "Volume", volume)
        versions.absorb_evenly(material)
    return material


def _varied(look: Any, name: str) -> Any:
    """The look with the colour that it has on a body or sheet of this name."""
    variation = getattr(look, "variation", 0.0)
    if variation == 0 or look.color is None:
        return look
    # of a checksum, since hashes of strings differ from process to process
    turn, gain = (zlib.crc32(f"{of} of {name}".encode()) / 2**31 - 1 for of in ("hue", "brightness"))
    hue, saturation, value = colorsys.rgb_to_hsv(*look.color)
    brighter = min(value * (1 + variation * gain), 1.0)
    color = colorsys.hsv_to_rgb((hue + HUES * variation * turn) % 1, saturation, brighter)
    return SimpleNamespace(**vars(look) | {"color": color})


def make_materials(
    name: str,
    look: Any,
    size: float,
    tinted: bool,
    otherwise: Any,
    *,
    caustics: Caustics | None = None,
    known: Known = "all",
    wet: Wet | None = None,
) -> list[Any]:
    """The Blender materials of a body, by the numbers that its faces have: one, or those of its mesh file and, last,
    what faces without any have. `tinted`, `caustics` and `known` are as in `make_material`."""
    if look.type != "imported":
        return [make_material(name, look, size, tinted=tinted, caustics=caustics, known=known, wet=wet)]
    parts = [SimpleNamespace(**vars(part) | {"type": look.type, "owner": name}) for part in look.materials]
    own = [(f"{name} {part.name}".rstrip(), part) for part in parts]
    kinds: dict[str, Any] = {"tinted": tinted, "caustics": caustics, "known": known, "wet": wet}
    return [make_material(label, part, size, **kinds) for label, part in [*own, (name, otherwise)]]


def default_body_look(index: int, tinted: bool = False) -> Any:
    """Look of the index-th rigid body when the scene names none; `tinted` if its vertices have colours."""
    return SimpleNamespace(type="plastic", color=None if tinted else PALETTE[index % len(PALETTE)], roughness=0.3)


def default_sheet_look(index: int) -> Any:
    """Look of the index-th sheet when the scene names none."""
    color = PALETTE[(index + 3) % len(PALETTE)]
    look = {"type": "cloth", "color": color, "back": None, "roughness": 0.8, "sheen": 0.3, "translucency": 0.15}
    return SimpleNamespace(**look, thickness=None, weave=None, hem=None)
