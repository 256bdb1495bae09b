"""What clear bodies share."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph


def clear(graph: Graph, color: tuple[float, ...], roughness: float, ior: float) -> Any:
    """A refracting surface that lets light fall straight through onto what is behind it.

    Shadow rays and diffuse bounces take the straight way, weakened as by Fresnel's law: the ground below
    water is then lit without tracing caustics, which a path tracer finds only by many more samples.
    """
    refracting = graph.node("BsdfGlass", {"Color": color, "Roughness": roughness, "IOR": ior}).outputs[0]
    through = graph.node("BsdfTransparent", {"Color": color}).outputs[0]
    mirror = graph.node("BsdfGlossy", {"Roughness": roughness}).outputs[0]
    # a straight ray meets the inner side at the outer angle: no total reflection there
    inside = graph.node("NewGeometry").outputs["Backfacing"]
    fresnel = graph.node(
        "Fresnel", {"IOR": graph.math("POWER", ior, graph.math("MULTIPLY_ADD", inside, -2.0, 1.0))}
    ).outputs[0]
    path = graph.node("LightPath")
    straight = graph.math("MAXIMUM", path.outputs["Is Shadow Ray"], path.outputs["Is Diffuse Ray"])
    return graph.mix(straight, refracting, graph.mix(fresnel, through, mirror))
