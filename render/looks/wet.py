"""What is wet: darker, more saturated, and shiny.

Light that a rough surface scatters into a film of liquid on it is thrown back at the film's surface, in part, and meets
the rough surface again, which absorbs some of it each time (Lekner & Dorf 1988): of the
reflectance r of the dry surface, r (1 - p) / (1 - p r) remains below the film, whose own reflection the coat adds. That
is less of every colour, and least of the darkest: what is wet is more saturated. Liquid in the pores of concrete,
wood or cloth does the same (Jensen et al. 1999); what has none, such as plastic, only gets the film.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from render.content.nodes import Graph

WATER = 1.333
"""Index of refraction of the film."""
DIFFUSE = 0.066
"""Share of light from all around that the film reflects from outside: the mean of Fresnel's law for this index."""
TRAPPED = 1 - (1 - DIFFUSE) / WATER**2
"""Share of scattered light that it throws back inside, p: 0.47."""
SMOOTH = 0.08
"""Roughness of the film, and of what is below it, at most."""


class Soaked(NamedTuple):
    """What water does to a look."""

    pores: float
    """Share of its surface that gets darker."""
    film: float
    """Share on which a film stays that shines; pores draw it in."""


LOOKS = {
    "matte": Soaked(1.0, 0.6),
    "cloth": Soaked(1.0, 0.25),
    "paper": Soaked(1.0, 0.25),
    "stone": Soaked(0.9, 0.7),
    "wood": Soaked(0.8, 0.7),
    "planks": Soaked(0.6, 0.9),
    "imported": Soaked(0.5, 0.7),
    "tiles": Soaked(0.15, 1.0),
    "lemon": Soaked(0.0, 1.0),
    "rubber": Soaked(0.0, 1.0),
    "plastic": Soaked(0.0, 1.0),
    "ceramic": Soaked(0.0, 1.0),
    "metal": Soaked(0.0, 1.0),
}
"""By type. What is clear has neither, as a film of water on glass is not seen; nor do looks of other packages."""
COLORS = {
    "BSDF_PRINCIPLED": "Base Color",
    "BSDF_DIFFUSE": "Color",
    "BSDF_TRANSLUCENT": "Color",
    "SUBSURFACE_SCATTERING": "Color",
}
"""The inputs of shaders that take what they reflect."""
DAMP = 0.5
"""Wetness from which on pores are full."""
DRAINED, STANDING = 0.5, 0.95
"""Wetness at which the film is gone, and above which it is whole: it goes before what is in the pores."""


def soaked(look: Any) -> Soaked:
    """What water does to a look."""
    found = LOOKS.get(look.type, Soaked(0.0, 0.0))
    varnish = getattr(look, "varnish", 0.0)
    return Soaked(found.pores * (1 - varnish), found.film + varnish * (1 - found.film))


def moisten(graph: Graph, look: Any, wet: Any, surface: Any) -> Any:
    """The shader of a surface that is as wet as the node output `wet` says; `surface` is its dry one."""
    change = soaked(look)
    nodes = [node for node in graph.tree.nodes if node.type in COLORS]
    if change.pores > 0:
        share = graph.math("MULTIPLY", graph.ramp(wet, 0.0, DAMP), change.pores)
        for node in nodes:
            _darken(graph, node, share)
    if change.film == 0:
        return surface
    film = graph.math("MULTIPLY", graph.ramp(wet, DRAINED, STANDING), change.film)
    coated = [node for node in nodes if node.type == "BSDF_PRINCIPLED"]
    for node in coated:
        weight = graph.given(node, "Coat Weight")
        graph.feed(node, "Coat Weight", graph.math("MAXIMUM", weight, film))
        for key in ("Roughness", "Coat Roughness"):
            rough = graph.given(node, key)
            graph.feed(node, key, graph.blend(film, rough, graph.math("MINIMUM", rough, _least(key))))
    if coated:
        return surface
    mirror = graph.node("BsdfGlossy", {"Color": (1.0,) * 4, "Roughness": SMOOTH}).outputs[0]
    fresnel = graph.node("Fresnel", {"IOR": WATER}).outputs[0]
    return graph.mix(graph.math("MULTIPLY", fresnel, film), surface, mirror)


def _least(key: str) -> float:
    return SMOOTH if key == "Coat Roughness" else 0.4


def _darken(graph: Graph, node: Any, share: Any) -> None:
    """Have a shader reflect what it does below a film, where `share` is 1."""
    dry = graph.given(node, COLORS[node.type])
    once = graph.node("VectorMath", {0: dry, 1: (1 - TRAPPED,) * 3}, operation="MULTIPLY").outputs[0]
    again = graph.node("VectorMath", {0: dry, 1: (-TRAPPED,) * 3, 2: (1.0,) * 3}, operation="MULTIPLY_ADD").outputs[0]
    below = graph.node("VectorMath", {0: once, 1: again}, operation="DIVIDE").outputs[0]
    graph.feed(node, COLORS[node.type], graph.mix_colors(share, dry, below))
