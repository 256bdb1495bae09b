"""Square tiles with joints, on whatever side of a body: they are laid along its own axes."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph, rgba

EDGE = 0.07
"""Of a tile over the diagonal of what is covered, unless set."""
JOINT = 0.025
"""Half the width of a joint over the edge of a tile."""


def edge(look: Any, size: float) -> float:
    """Edge of a tile, joint included [m]."""
    return look.edge or EDGE * size


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    red, green, blue, _ = rgba(look.color)
    darkest, lightest = 1 - 0.45 * look.tone_variation, 1 + 0.15 * look.tone_variation
    dark, light = ((red * k, green * k, blue * k, 1.0) for k in (darkest, lightest))
    inputs = {
        "Vector": _along_faces(graph),
        "Color1": dark,
        "Color2": light,
        "Mortar": rgba(look.joint),
        "Scale": 1.0,
        "Mortar Size": JOINT * edge(look, size),
        "Mortar Smooth": 0.3,
        "Brick Width": edge(look, size),
        "Row Height": edge(look, size),
    }
    bricks = graph.node("TexBrick", inputs, offset=0.0)
    tile = graph.math("SUBTRACT", 1.0, bricks.outputs["Fac"])
    bump = graph.node("Bump", {"Strength": 0.4, "Distance": 0.03 * edge(look, size), "Height": tile}).outputs[0]
    roughness = graph.math("MULTIPLY_ADD", bricks.outputs["Fac"], 1.0 - look.roughness, look.roughness)
    shader = {"Base Color": bricks.outputs["Color"], "Roughness": roughness, "Normal": bump}
    return graph.node("BsdfPrincipled", shader).outputs[0], None


def _along_faces(graph: Graph) -> Any:
    """Place along the face: the two of the body's coordinates [m] to which it is least inclined."""
    coordinates = graph.node("TexCoord")
    x, y, z = graph.node("SeparateXYZ", {0: coordinates.outputs["Object"]}).outputs
    normal = graph.node("SeparateXYZ", {0: coordinates.outputs["Normal"]}).outputs
    right, front, up = (graph.math("ABSOLUTE", part) for part in normal)
    upright = graph.math("LESS_THAN", up, graph.math("MAXIMUM", right, front))
    sideways = graph.math("MULTIPLY", upright, graph.math("GREATER_THAN", right, front))
    first = graph.node("Mix", {2: x, 3: y, 0: sideways}).outputs[0]
    second = graph.node("Mix", {2: y, 3: z, 0: upright}).outputs[0]
    return graph.node("CombineXYZ", {0: first, 1: second}).outputs[0]
