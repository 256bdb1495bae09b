"""The sun and the lamps."""

from __future__ import annotations

import math
from typing import Any

from render.blender.session import bpy
from render.content.axes import Vector, triple, z_up
from render.content.camera import face
from render.content.framing import View, direction
from render.content.nodes import rgba
from render.inputs import Box

DISTANCE = 1.6
"""Of a softbox from the middle of the action, over its diagonal."""
SOFTBOXES = (("key", -42.0, 48.0, 1.2, 1.0), ("fill", 62.0, 22.0, 1.6, 0.33), ("rim", 165.0, 42.0, 0.9, 0.67))
"""Name, azimuth from the camera's [deg], elevation [deg], edge over the action's diagonal, share of the irradiance."""


def add_lights(settings: Any, box: Box, view: View) -> None:
    """Add the sun, the area lights, and softboxes around the box of the action."""
    if settings.sun.strength > 0:
        _add_sun(settings.sun)
    for index, area in enumerate(settings.areas):
        _add_area(f"area{index}", area)
    if settings.softboxes > 0:
        _add_softboxes(settings.softboxes, box, view)


def _add_softboxes(irradiance: float, box: Box, view: View) -> None:
    """Not seen by the camera, but in mirrors."""
    x, y, _ = (a - b for a, b in zip(view.position, view.target, strict=True))
    around, away = math.degrees(math.atan2(x, -y)), DISTANCE * box.diagonal
    for name, azimuth, elevation, edge, share in SOFTBOXES:
        lamp = bpy.data.lights.new(name, "AREA")
        lamp.size = edge * box.diagonal
        lamp.energy = share * irradiance * lamp.size**2 / _view_factor(lamp.size, away)
        toward = direction(around + azimuth, elevation)
        position = triple(c + away * t for c, t in zip(box.center, toward, strict=True))
        thing = _add(name, lamp, (1.0, 1.0, 1.0), position, toward)
        thing.visible_camera = thing.visible_transmission = False


def _view_factor(edge: float, distance: float) -> float:
    """Irradiance of a surface that faces a square lamp straight, over the lamp's power per area: in closed form the sum
    over its four quarters."""
    half = edge / 2 / distance
    near = math.sqrt(1 + half**2)
    return 4 / math.pi * half / near * math.atan(half / near)


def _add_sun(settings: Any) -> None:
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy = settings.strength
    sun.angle = math.radians(settings.angle)
    _add("sun", sun, settings.color, (0.0, 0.0, 0.0), direction(settings.azimuth, settings.elevation))


def _add_area(name: str, settings: Any) -> None:
    lamp = bpy.data.lights.new(name, "AREA")
    lamp.energy = settings.power
    lamp.size = settings.size
    position, target = z_up(settings.position), z_up(settings.target)
    toward = triple(p - q for p, q in zip(position, target, strict=True))
    _add(name, lamp, settings.color, position, toward)


def _add(name: str, light: Any, color: Any, position: Vector, toward: Vector) -> Any:
    light.color = rgba(color)[:3]
    thing = bpy.data.objects.new(name, light)
    face(thing, position, toward)
    bpy.context.scene.collection.objects.link(thing)
    return thing
