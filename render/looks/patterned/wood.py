"""Wood: annual rings about the pith of the tree that it was sawn from, and fibres along it."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba

RING = 0.03
"""Width of an annual ring over the body's diagonal, unless set."""
PITH = (7.3, 12.9)
"""How far beside the middle of the body the pith lies, in rings: boards are rarely sawn from the heart."""
ALONG = 0.06
"""How often things change along the trunk, over how often across."""
CELLULOSE = 1.53
"""Index of refraction."""
ACROSS = {"x": "YZ", "y": "XY", "z": "XZ"}
"""Blender's axes across the trunk, by the scene's axis along it."""
TRUNK = {"x": (ALONG, 1.0, 1.0), "y": (1.0, 1.0, ALONG), "z": (1.0, ALONG, 1.0)}
"""Blender's place shortened along it."""


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    per_ring = 1 / (look.grain or RING * size)
    place = graph.place()
    drawn_out = graph.node("VectorMath", {0: place, 1: TRUNK[look.along]}, operation="MULTIPLY").outputs[0]
    wander = graph.node("TexNoise", {"Vector": drawn_out, "Scale": 0.15 * per_ring, "Detail": 2.0}).outputs[0]
    fibres = graph.node("TexNoise", {"Vector": drawn_out, "Scale": 8 * per_ring, "Detail": 4.0}).outputs[0]
    axes = graph.node("SeparateXYZ", {0: place})
    first, second = (
        graph.math("MULTIPLY_ADD", axes.outputs[axis], per_ring, shift)
        for axis, shift in zip(ACROSS[look.along], PITH, strict=True)
    )
    rings = graph.math("SQRT", graph.math("ADD", graph.math("POWER", first, 2.0), graph.math("POWER", second, 2.0)))
    age = graph.math("FRACT", graph.math("MULTIPLY_ADD", wander, 3.0, rings))
    # it grows fast and light in spring, ever slower and darker towards autumn, and ends abruptly
    late = graph.math("MULTIPLY", graph.math("POWER", age, 2.5), graph.ramp(age, 1.0, 0.9))
    shade = graph.math("MULTIPLY_ADD", graph.math("SUBTRACT", fibres, 0.5), 0.8, graph.math("MULTIPLY", late, 0.9))
    red, green, blue, _ = rgba(look.color)
    dark = (0.45 * red, 0.37 * green, 0.3 * blue, 1.0)
    color = graph.mix_colors(graph.math("MAXIMUM", shade, 0.0), (red, green, blue, 1.0), dark)
    bump = graph.node("Bump", {"Strength": 0.3, "Distance": 0.02 / per_ring, "Height": fibres}).outputs[0]
    inputs = {"Base Color": color, "Roughness": look.roughness, "IOR": CELLULOSE, "Normal": bump}
    inputs |= {"Coat Weight": look.varnish, "Coat Roughness": 0.05}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
