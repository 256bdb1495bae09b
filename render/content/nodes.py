"""Building shader node trees briefly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from render.blender import versions
from render.blender.session import bpy

TINT = "tint"
"""Name of the meshes' attribute with the colours of the vertices; Cycles would show `color` black."""
LAST = 2
"""Bounces that a path keeps for what is opaque: Cycles lights nothing at the last of them."""


def rgba(color: Sequence[float]) -> tuple[float, float, float, float]:
    """An sRGB colour of the settings as linear light with full opacity."""
    red, green, blue = (_linear(channel) for channel in color)
    return (red, green, blue, 1.0)


def _linear(channel: float) -> float:
    return channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4


REST = "rest"
"""Likewise, with the places of their points in the cloth at rest [m]: a sheet lies in the first two axes."""
RIM = "rim"
"""Likewise, with the distances of their points from its rim [m]."""


@dataclass(frozen=True)
class Caustics:
    """Clear bodies refract light on its way to what it lights. Where Cycles finds no such way, the sun's light goes
    straight through, if `toward` is the unit vector towards it, in Blender's axes; `cosine` is that of half its
    apparent diameter, or a bit less."""

    toward: tuple[float, float, float] | None = None
    cosine: float = 1.0


class Graph:
    """The nodes of a material or world. An input takes a value or another node's output.

    `rests`: of a mesh with REST and RIM. `thick`: of a sheet that is drawn with a thickness, so that it has an inside.
    """

    def __init__(self, tree: Any, rests: bool = False, thick: bool = False, caustics: Caustics | None = None):
        self.tree = tree
        self.rests = rests
        self.thick = thick
        self.caustics = caustics

    @classmethod
    def new(cls, owner: Any, rests: bool = False, thick: bool = False, caustics: Caustics | None = None) -> Graph:
        """The empty graph of a new material or world."""
        return cls(versions.empty_nodes(owner), rests, thick, caustics)

    def node(self, kind: str, inputs: Mapping[str, Any] | Mapping[int, Any] | None = None, **properties: Any) -> Any:
        """Add a node; inputs are named, or numbered where names repeat."""
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in properties.items():
            setattr(node, name, value)
        for key, value in (inputs or {}).items():
            self.feed(node, key, value)
        return node

    def feed(self, node: Any, key: str | int, value: Any) -> None:
        """Set or link one input; an input that this Blender does not know is left out."""
        socket = node.inputs[key] if isinstance(key, int) else versions.input_named(node, key)
        if socket is None:
            return
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def given(self, node: Any, key: str) -> Any:
        """The output that an input of a node is linked to, or a new one with its value."""
        socket = versions.input_named(node, key)
        if socket.links:
            return socket.links[0].from_socket
        source = self.node("RGB" if socket.type == "RGBA" else "Value").outputs[0]
        source.default_value = socket.default_value
        return source

    def feed_shaders(self, kinds: Sequence[str], keys: Sequence[str], value: Any) -> None:
        """Feed those of these inputs that shaders of these types have."""
        for node in [node for node in self.tree.nodes if node.type in kinds]:
            for key in keys:
                self.feed(node, key, value)

    def override(self, key: str, value: Any) -> None:
        """Set an input of every Principled BSDF, in place of what it was linked to."""
        for node in (node for node in self.tree.nodes if node.type == "BSDF_PRINCIPLED"):
            socket = versions.input_named(node, key)
            if socket is not None:
                for link in socket.links:
                    self.tree.links.remove(link)
                socket.default_value = value

    def tint(self) -> Any:
        """The colour that the mesh has there."""
        return self.node("Attribute", attribute_name=TINT).outputs["Color"]

    def exhausted(self) -> Any:
        """1 once a light path has crossed nearly as many surfaces as the scene's bounces allow, else 0.

        What is left of them lights an opaque surface that it then meets.
        """
        limit = bpy.context.scene.cycles.max_bounces - LAST
        return self.math("GREATER_THAN", self.node("LightPath").outputs["Ray Depth"], max(limit, 1) - 0.5)

    def place(self) -> Any:
        """Where a point of the body is, in metres and in axes that move with it; of a sheet, where in the cloth."""
        if self.rests:
            return self.node("Attribute", attribute_name=REST).outputs["Vector"]
        return self.node("TexCoord").outputs["Object"]

    def rim(self) -> Any:
        """How far a point of a sheet is from its rim, in the cloth [m]."""
        return self.node("Attribute", attribute_name=RIM).outputs["Fac"]

    def math(self, operation: str, *operands: Any) -> Any:
        """Output of an arithmetic operation."""
        return self.node("Math", dict(enumerate(operands)), operation=operation).outputs[0]

    def ramp(self, value: Any, low: float, high: float) -> Any:
        """0 below `low`, 1 above `high`, smooth in between."""
        inputs = {"Value": value, "From Min": low, "From Max": high}
        return self.node("MapRange", inputs, interpolation_type="SMOOTHSTEP").outputs[0]

    def color_ramp(self, value: Any, stops: Sequence[tuple[float, float, float, float]]) -> Any:
        """The first of some linear colours at 0, the last at 1, the others at even distances between, and straight from
        each to the next."""
        node = self.node("ValToRGB", {0: value})
        elements = node.color_ramp.elements
        for index, color in enumerate(stops):
            place = index / (len(stops) - 1)
            element = elements[0] if index == 0 else elements[-1] if place == 1 else elements.new(place)
            element.color = color
        return node.outputs["Color"]

    def mix(self, share: Any, first: Any, second: Any) -> Any:
        """Blend of two shaders: `second` where `share` is 1."""
        return self.node("MixShader", {0: share, 1: first, 2: second}).outputs[0]

    def blend(self, share: Any, first: Any, second: Any) -> Any:
        """Blend of two numbers: `second` where `share` is 1."""
        return self.math("MULTIPLY_ADD", share, self.math("SUBTRACT", second, first), first)

    def mix_colors(self, share: Any, first: Any, second: Any) -> Any:
        """Blend of two linear colours: `second` where `share` is 1."""
        return self.node("MixRGB", {0: share, 1: first, 2: second}).outputs[0]

    def multiply_colors(self, first: Any, second: Any) -> Any:
        """Product of two linear colours."""
        return self.node("MixRGB", {0: 1.0, 1: first, 2: second}, blend_type="MULTIPLY").outputs[0]

    def channel(self, color: Any, name: str | None) -> Any:
        """Red, green or blue of a colour; its brightness without a name."""
        if name is None:
            return self.node("RGBToBW", {0: color}).outputs[0]
        return self.node("SeparateColor", {0: color}).outputs[name.capitalize()]
