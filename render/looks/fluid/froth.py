"""Foam that floats: white, soft, and broken up; and bubbles.

Of discs that lie about at random, with an area of s times the ground's, exp(-s) of the ground is left bare.
"""

from __future__ import annotations

import math
from typing import Any

from common.attributes import FOAM
from render.content.nodes import Graph, rgba

CELL = 0.004
"""Size of the patches into which it breaks, over the diagonal of the box of the action, unless set."""
BROKEN = 4.0
"""How much more foam there is in a patch than in a gap: noise lies between 0.3 and 0.7, mostly."""
TRANSLUCENT = 0.3
"""Share of the light that a layer lets through: thin walls scatter it forwards, too."""
MILKY = 0.5
"""Share of the light on the rim of a bubble that is scattered: one in the picture stands for many smaller ones."""


def bubble(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    """A ball of air within what has the index `ior` of refraction: light that meets it at a flat angle is reflected in
    full, so that its rim is bright, and most other light goes through."""
    fresnel = graph.node("Fresnel", {"IOR": 1 / look.ior}).outputs[0]
    mirror = graph.node("BsdfGlossy", {"Color": (1.0,) * 4, "Roughness": 0.0}).outputs[0]
    rim = graph.mix(MILKY, mirror, _white(graph, look.color, 0.5))
    path = graph.node("LightPath").outputs
    straight = graph.math("MAXIMUM", path["Is Shadow Ray"], path["Is Diffuse Ray"])
    seen = graph.math("MULTIPLY", fresnel, graph.math("SUBTRACT", 1.0, straight))
    return graph.mix(seen, graph.node("BsdfTransparent").outputs[0], rim), None


def cover(graph: Graph, look: Any, size: float, below: Any) -> Any:
    """The shader of water whose own is `below`, with what foam is on it."""
    density = graph.node("Attribute", attribute_name=FOAM).outputs["Fac"]
    bare = graph.math("POWER", 1 / math.e, graph.math("MULTIPLY", density, look.cover))
    per_metre = 1 / (look.cell or CELL * size)
    place = graph.node("NewGeometry").outputs["Position"]
    noise = graph.node("TexNoise", {"Vector": place, "Scale": per_metre, "Detail": 3.0}).outputs[0]
    patches = graph.math("MULTIPLY_ADD", graph.math("SUBTRACT", noise, 0.5), BROKEN, 1.0)
    share = graph.math("MULTIPLY", graph.math("SUBTRACT", 1.0, bare), patches)
    share = graph.node("Clamp", {"Value": share}).outputs[0]
    return graph.mix(share, below, _white(graph, look.color, TRANSLUCENT))


def _white(graph: Graph, color: Any, translucent: float) -> Any:
    """A shader that scatters light, a share of it to the other side."""
    scattered = (graph.node(f"Bsdf{kind}", {"Color": rgba(color)}).outputs[0] for kind in ("Diffuse", "Translucent"))
    return graph.mix(translucent, *scattered)
