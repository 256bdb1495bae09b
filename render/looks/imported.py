"""A material of a mesh file: glTF's model of metals and what is none, which MTL is read as, too."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph
from render.texturing.nodes import imported_image


def build(graph: Graph, look: Any, size: float) -> tuple[Any, Any]:
    inputs = {
        "Base Color": _color(graph, look, "base"),
        "Metallic": _number(graph, look, "metallic"),
        "Roughness": _number(graph, look, "roughness"),
        "Emission Color": _color(graph, look, "emission"),
        "Emission Strength": look.emission_strength,
        "Specular IOR Level": look.specular,
        "IOR": look.ior,
        "Transmission Weight": look.transmission,
        "Coat Weight": look.coat,
        "Coat Roughness": look.coat_roughness,
        "Alpha": _opacity(graph, look),
    }
    relief = _image(graph, look, "normal_map")
    if relief is not None:
        directions = {"Color": relief.outputs["Color"], "Strength": look.normal_scale}
        inputs["Normal"] = graph.node("NormalMap", directions).outputs[0]
    return graph.node("BsdfPrincipled", inputs).outputs[0], None


def _image(graph: Graph, look: Any, setting: str) -> Any:
    """Its node; None without one."""
    image = getattr(look, setting)
    return None if image is None else imported_image(graph, look.owner, setting, image)


def _color(graph: Graph, look: Any, setting: str) -> Any:
    factor, node = (*getattr(look, setting), 1.0), _image(graph, look, f"{setting}_map")
    return factor if node is None else graph.multiply_colors(node.outputs["Color"], factor)


def _number(graph: Graph, look: Any, setting: str) -> Any:
    factor, node = getattr(look, setting), _image(graph, look, f"{setting}_map")
    if node is None:
        return factor
    channel = getattr(look, f"{setting}_map").channel
    return graph.math("MULTIPLY", graph.channel(node.outputs["Color"], channel), factor)


def _opacity(graph: Graph, look: Any) -> Any:
    node = _image(graph, look, "alpha_map")
    if node is None:
        return look.alpha if look.cutoff is None else float(look.alpha >= look.cutoff)
    channel = look.alpha_map.channel
    seen = node.outputs["Alpha"] if channel is None else graph.channel(node.outputs["Color"], channel)
    opacity = graph.math("MULTIPLY", seen, look.alpha)
    # Opaque at the limit itself, where rounding must not decide.
    return opacity if look.cutoff is None else graph.math("GREATER_THAN", opacity, look.cutoff - 1e-6)
