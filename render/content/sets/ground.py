"""The ground: a wide disc that fades into the background, so that no horizon line shows."""

from __future__ import annotations

import math
from typing import Any

from render.blender.session import bpy
from render.content.axes import Vector
from render.content.framing import View
from render.content.materials import Wet, make_material
from render.content.meshes import add_object
from render.content.nodes import Graph
from render.content.sets.images import lay_images
from render.inputs import Box
from render.looks.simple import Known

NEAR, FAR = 1.5, 9.0
"""Where the ground begins to fade and where it is gone, over the camera's distance from the action's centre."""


def add_ground(settings: Any, height: float, box: Box, view: View, known: Known = "all", wet: Wet | None = None) -> Any:
    """Add the ground at a height [m] below the box of the action; returns the object. `wet` as materials have it."""
    x, y, _ = box.center
    reach = max(box.diagonal, math.dist(view.position, (x, y, height)))
    material = make_material("ground", settings.material, box.diagonal, known=known, wet=wet)
    plain = add_plain(material, (x, y, height), reach, known)
    lay_images(plain, settings.material, box.diagonal)
    return plain


def add_plain(material: Any, middle: Vector, reach: float, known: Known = "all") -> Any:
    """Add level ground around a point [m], which cameras look at from no farther than `reach` [m]; returns the
    object. It fades where Blender itself shows it."""
    if known == "all":
        fade(material, NEAR * reach, FAR * reach)
    mesh = bpy.data.meshes.new("ground")
    rim = 1.01 * FAR * reach
    corners = [(-rim, -rim, 0.0), (rim, -rim, 0.0), (rim, rim, 0.0), (-rim, rim, 0.0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    thing = add_object("ground", mesh, material)
    thing.location = middle
    return thing


def fade(material: Any, near: float, far: float) -> None:
    """Let a material vanish between two distances from the middle of what it covers [m]."""
    graph, output, opaque = surface_of(material)
    place = graph.node("TexCoord").outputs["Object"]
    distance = graph.node("VectorMath", {0: place}, operation="LENGTH").outputs["Value"]
    gone = graph.node("BsdfTransparent").outputs[0]
    graph.feed(output, "Surface", graph.mix(graph.ramp(distance, near, far), opaque, gone))


def surface_of(material: Any) -> tuple[Graph, Any, Any]:
    """The graph of a material, its output node, and the shader of the surface that goes there."""
    output = next(node for node in material.node_tree.nodes if node.type == "OUTPUT_MATERIAL")
    return Graph(material.node_tree), output, output.inputs["Surface"].links[0].from_socket
