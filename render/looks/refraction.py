"""What clear bodies share."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph


def clear(graph: Graph, color: Any, roughness: float, ior: float, thin: bool = False) -> Any:
    """A refracting surface that lets light fall straight through onto what is behind it.

    Shadow rays and diffuse bounces take the straight way, weakened as by Fresnel's law: the ground below
    water is then lit without tracing caustics, which a path tracer finds only by many more samples. If `thin`, all do.
    With caustics only shadow rays to the sun do so, and only where Cycles finds no way that is refracted.
    Light that was thrown back within until its bounces are spent goes straight out, where Cycles would end it: a pane
    is dark along its edges otherwise, and so are drops. Not with caustics, whose ways Cycles looks for in what refracts
    at any depth.
    """
    through = graph.node("BsdfTransparent", {"Color": color}).outputs[0]
    mirror = graph.node("BsdfGlossy", {"Color": (1.0,) * 4, "Roughness": roughness}).outputs[0]
    # a straight ray meets the inner side at the outer angle: no total reflection there
    geometry = graph.node("NewGeometry").outputs
    fresnel = graph.node(
        "Fresnel", {"IOR": graph.math("POWER", ior, graph.math("MULTIPLY_ADD", geometry["Backfacing"], -2.0, 1.0))}
    ).outputs[0]
    pane = graph.mix(fresnel, through, mirror)
    if thin:
        return graph.mix(graph.exhausted(), pane, through)
    refracting = graph.node("BsdfGlass", {"Color": color, "Roughness": roughness, "IOR": ior}).outputs[0]
    path = graph.node("LightPath")
    straight = graph.math("MAXIMUM", path.outputs["Is Shadow Ray"], path.outputs["Is Diffuse Ray"])
    if graph.caustics is None:
        return graph.mix(graph.exhausted(), graph.mix(straight, refracting, pane), through)
    if graph.caustics.toward is None:
        return refracting
    back = tuple(-part for part in graph.caustics.toward)
    cosine = graph.node("VectorMath", {0: geometry["Incoming"], 1: back}, operation="DOT_PRODUCT").outputs["Value"]
    to_sun = graph.math("GREATER_THAN", cosine, graph.caustics.cosine)
    return graph.mix(graph.math("MULTIPLY", path.outputs["Is Shadow Ray"], to_sun), refracting, pane)
