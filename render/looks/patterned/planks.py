"""Boards of wood side by side, each with its own grain, which runs along x of the body."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba

BOARD = 0.16
"""Width of a board over the diagonal of what is covered, unless set."""
LONG = 1000.0
"""Length of a board over its width: they have no ends."""


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    width = look.board or BOARD * size
    place = graph.node("TexCoord").outputs["Object"]
    # one begins in the middle of the texture's first, whose end would be a joint across the ground
    begun = graph.node("Mapping", {"Vector": place, "Location": (LONG * width / 2, 0.0, 0.0)}).outputs[0]
    rows = {"Vector": begun, "Scale": 1.0, "Brick Width": LONG * width, "Row Height": width}
    joints = {"Mortar": (0.5, 0.5, 0.5, 1), "Mortar Size": 0.006 * width, "Mortar Smooth": 0.2}
    tones = {"Color1": (0, 0, 0, 1), "Color2": (1, 1, 1, 1), "Bias": 0.0}
    boards = graph.node("TexBrick", rows | joints | tones, offset=0.0)
    own = graph.node("SeparateXYZ", {0: boards.outputs["Color"]}).outputs[0]
    # each board is cut from another place of the trunk
    y = graph.node("SeparateXYZ", {0: place}).outputs[1]
    row = graph.math("FLOOR", graph.math("DIVIDE", y, width))
    along, across = graph.math("MULTIPLY", row, 3.7 * width), graph.math("MULTIPLY", row, width)
    shift = graph.node("CombineXYZ", {0: along, 2: across}).outputs[0]
    moved = graph.node("VectorMath", {0: place, 1: shift}, operation="ADD").outputs[0]
    stretched = graph.node("Mapping", {"Vector": moved, "Scale": (0.09, 1.0, 1.0)}).outputs[0]
    curved = {"Vector": stretched, "Scale": 5 / width, "Detail": 4.0, "Distortion": 1.2}
    rings = graph.node("TexNoise", curved).outputs[0]
    fibres = graph.node("Mapping", {"Vector": moved, "Scale": (0.02, 1.0, 1.0)}).outputs[0]
    pores = graph.node("TexNoise", {"Vector": fibres, "Scale": 60 / width, "Detail": 3.0}).outputs[0]
    red, green, blue, _ = rgba(look.color)
    dark, light = ((red * k, green * k * (k + 1) / 2, blue * k * k, 1.0) for k in (0.55, 1.15))
    grain = graph.math("ADD", graph.math("MULTIPLY", rings, 0.75), graph.math("MULTIPLY", pores, 0.25))
    toned = graph.math("MULTIPLY_ADD", graph.math("SUBTRACT", own, 0.5), 0.12, grain)
    color = graph.mix_colors(graph.ramp(toned, 0.33, 0.67), dark, light)
    gap = graph.mix_colors(boards.outputs["Fac"], color, (red * 0.15, green * 0.12, blue * 0.1, 1.0))
    height = graph.math("SUBTRACT", graph.math("MULTIPLY", pores, 0.2), boards.outputs["Fac"])
    bump = graph.node("Bump", {"Strength": 0.3, "Distance": 0.01 * width, "Height": height}).outputs[0]
    inputs = {"Base Color": gap, "Roughness": look.roughness, "Normal": bump}
    return graph.node("BsdfPrincipled", inputs).outputs[0], None
