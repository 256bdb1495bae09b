"""Walls around the action that are not seen from behind.

Each is as wide as a horizon, so that they meet wherever the camera stands: it sees those sides that face it, and looks
through the others, as into a doll's house. For light it is a room without a roof, and lamps shine through its walls.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from render.content.axes import Vector
from render.content.sets.ground import surface_of
from render.content.sets.site import Site, add_mesh

WIDE = 9.0
"""Half the width of a wall, over the distance of the farthest camera."""


@dataclass(frozen=True)
class Side:
    """One side: its direction outwards along x or y, and how far out it is [m]."""

    axis: int
    sign: int
    distance: float

    def point(self, along: float, out: float, up: float) -> Vector:
        """A point at a way along the wall and beyond it [m], counted from the middle of the ground."""
        outward = self.sign * (self.distance + out)
        sideways = along * (self.sign if self.axis else -self.sign)
        return (sideways, outward, up) if self.axis else (outward, sideways, up)


def sides(half: tuple[float, float]) -> Iterator[Side]:
    """All four, from half the extents in x and y [m]."""
    for axis, distance in enumerate(half):
        for sign in (-1, 1):
            yield Side(axis, sign, distance)


def add_strip(name: str, side: Side, site: Site, profile: list[tuple[float, float]], material: Any) -> Any:
    """Put a strip along a side into the scene: `profile` holds how far beyond the wall and how high it is [m], from the
    inside outwards. Returns the object."""
    wide = WIDE * site.reach
    corners = [side.point(along, out, up) for out, up in profile for along in (-wide, wide)]
    faces: list[tuple[int, ...]] = [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(len(profile) - 1)]
    thing = add_mesh(name, corners, faces, material, site.middle)
    thing.visible_shadow = False
    return thing


def seen_from_inside(material: Any, side: Side, site: Site) -> Any:
    """Let rays through that come from beyond a side; returns the material."""
    graph, output, opaque = surface_of(material)
    geometry = graph.node("NewGeometry").outputs
    length = graph.node("LightPath").outputs["Ray Length"]
    # where the ray comes from: its direction is towards there
    way = graph.node("VectorMath", {0: geometry["Incoming"], 3: length}, operation="SCALE").outputs[0]
    start = graph.node("VectorMath", {0: geometry["Position"], 1: way}, operation="ADD").outputs[0]
    place = graph.node("SeparateXYZ", {0: start}).outputs[side.axis]
    beyond = graph.math("MULTIPLY", graph.math("SUBTRACT", place, site.middle[side.axis]), float(side.sign))
    outside = graph.math("GREATER_THAN", beyond, side.distance)
    graph.feed(output, "Surface", graph.mix(outside, opaque, graph.node("BsdfTransparent").outputs[0]))
    return material
