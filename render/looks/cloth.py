"""Woven cloth: warp and weft, a hem along the rim; soft, with a sheen, letting some light through."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from render.content.nodes import Graph, rgba
from render.looks.translucency import lit_through

THREAD = 1 / 250
"""Distance of threads over the diagonal of the sheet at rest, unless set."""
HEM = 0.02
"""Width of the hem over that diagonal, unless set."""
STITCH = 0.8
"""Where the seam of the hem runs, over its width."""
UNEVEN = 0.16
"""How much brighter the brightest thread is than the darkest."""


@dataclass(frozen=True)
class Relief:
    """What the look of cloth is made of: height above the lowest point from 0 to 1, and brightness over the
    colour's."""

    height: Any
    shade: Any


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    thread = THREAD * size if look.weave is None else look.weave
    hem = HEM * size if look.hem is None else look.hem
    inputs = {
        "Roughness": 0.9,
        "Specular IOR Level": 0.1,
        "Sheen Weight": look.sheen,
        "Sheen Roughness": look.roughness,
    }
    shade: Any = 1.0
    if graph.rests and thread > 0:
        woven = _weave(graph, thread)
        shade = woven.shade
        inputs["Normal"] = _bump(graph, woven.height, 0.35 * thread)
    if graph.rests and hem > 0:
        folded = _hem(graph, hem)
        shade = graph.math("MULTIPLY", shade, folded.shade)
        inputs["Normal"] = _bump(graph, folded.height, 0.1 * hem, inputs.get("Normal"))
    color = graph.mix_colors(shade, (0.0, 0.0, 0.0, 1.0), rgba(look.color))
    cloth = graph.node("BsdfPrincipled", inputs | {"Base Color": color}).outputs[0]
    return lit_through(graph, look.translucency, cloth, color), None


def _weave(graph: Graph, thread: float) -> Relief:
    """Plain weave: each thread goes over one and under the next of those across it."""
    places = graph.node("SeparateXYZ", {0: graph.place()})
    u, v = (graph.math("DIVIDE", places.outputs[axis], thread) for axis in "XY")
    column, row = graph.math("FLOOR", u), graph.math("FLOOR", v)
    weft_above = graph.math("ABSOLUTE", graph.math("MODULO", graph.math("ADD", column, row), 2.0))
    ridges = [graph.math("ABSOLUTE", graph.math("SINE", graph.math("MULTIPLY", axis, math.pi))) for axis in (u, v)]
    across = graph.blend(weft_above, *ridges)
    along = graph.blend(weft_above, *reversed(ridges))
    round_thread = graph.math("SQRT", across)
    height = graph.math("MULTIPLY", round_thread, graph.math("MULTIPLY_ADD", along, 0.6, 0.4))
    number = graph.blend(weft_above, column, graph.math("ADD", row, 0.5))
    own = graph.node("TexWhiteNoise", {"W": number}, noise_dimensions="1D").outputs["Value"]
    dye = graph.math("MULTIPLY_ADD", own, UNEVEN, 1 - UNEVEN)
    gaps = graph.math("MULTIPLY_ADD", height, 0.45, 0.55)
    return Relief(height, graph.math("MULTIPLY", dye, gaps))


def _hem(graph: Graph, width: float) -> Relief:
    """The rim, folded over and held by a seam."""
    inwards = graph.math("DIVIDE", graph.rim(), width)
    fold = graph.ramp(inwards, 1.0, 0.93)
    seam = graph.ramp(graph.math("ABSOLUTE", graph.math("SUBTRACT", inwards, STITCH)), 0.07, 0.03)
    height = graph.math("SUBTRACT", fold, graph.math("MULTIPLY", seam, 0.6))
    shade = graph.math("SUBTRACT", 1.0, graph.math("MULTIPLY_ADD", fold, 0.08, graph.math("MULTIPLY", seam, 0.3)))
    return Relief(height, shade)


def _bump(graph: Graph, height: Any, distance: float, below: Any = None) -> Any:
    inputs = {"Strength": 1.0, "Distance": distance, "Height": height}
    return graph.node("Bump", inputs | ({} if below is None else {"Normal": below})).outputs[0]
