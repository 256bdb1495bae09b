"""The skin of a lemon: pits of its oil glands, a film of wax, and light that wanders about below."""

from __future__ import annotations

from typing import Any

from render.blender import versions
from render.content.nodes import Graph, rgba

PORES = 0.022
"""Distance of the pits over the body's diagonal, unless set: 2.5 mm of a lemon of 8 cm, whose box has 11 cm."""
SPREAD = 0.02
"""How far red light gets below the skin over the body's diagonal: 2 mm of such a lemon."""
FARTHER = (1.0, 0.8, 0.2)
"""How far red, green and blue get, over that: the peel absorbs blue."""
WAX = 1.44
"""Index of refraction."""


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    pores = look.grain or PORES * size
    place = graph.place()
    pits = graph.node("TexVoronoi", {"Vector": place, "Scale": 1 / pores}, feature="SMOOTH_F1").outputs["Distance"]
    depth = graph.ramp(pits, 0.05, 0.5)
    bump = graph.node("Bump", {"Strength": 0.5, "Distance": 0.2 * pores, "Height": depth}).outputs[0]
    red, green, blue, _ = color = rgba(look.color)
    ripe = graph.node("TexNoise", {"Vector": place, "Scale": 3 / size, "Detail": 2.0}).outputs[0]
    skin = graph.mix_colors(graph.ramp(ripe, 0.45, 0.8), color, (0.7 * red, 0.95 * green, blue, 1.0))
    skin = graph.mix_colors(graph.math("MULTIPLY", graph.ramp(pits, 0.25, 0.0), 0.35), skin, (red, 0.8 * green, 0.0, 1))
    inputs = {"Base Color": skin, "Roughness": look.roughness, "IOR": WAX, "Normal": bump}
    inputs |= {"Coat Weight": look.wax, "Coat Roughness": 0.5 * look.roughness, "Coat IOR": WAX, "Coat Normal": bump}
    inputs |= {"Subsurface Weight": look.translucency, "Subsurface Scale": 1.0}
    inputs |= {"Subsurface Radius": tuple(SPREAD * size * share for share in FARTHER)}
    shader = graph.node("BsdfPrincipled", inputs)
    versions.color_below_surface(graph.tree, shader)
    return shader.outputs[0], None
