"""The sun and the lamps."""

from __future__ import annotations

import math
from typing import Any

from render.blender.session import bpy
from render.content.axes import Vector, triple, z_up
from render.content.camera import face
from render.content.framing import direction
from render.content.nodes import rgba


def add_lights(settings: Any) -> None:
    """Add the sun and the area lights."""
    if settings.sun.strength > 0:
        _add_sun(settings.sun)
    for index, area in enumerate(settings.areas):
        _add_area(f"area{index}", area)


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


def _add(name: str, light: Any, color: Any, position: Vector, toward: Vector) -> None:
    light.color = rgba(color)[:3]
    thing = bpy.data.objects.new(name, light)
    face(thing, position, toward)
    bpy.context.scene.collection.objects.link(thing)
