"""Light from all around, and what the camera sees behind the scene."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from render.blender.session import bpy
from render.content.nodes import Graph, rgba
from render.texturing import images

BACKDROP = 1.5
"""Brightness of a background of colour 1: like a white ground in the default light, so that the two meet unseen."""
GRADIENT_TOP = 0.7
"""Sine of the elevation at which the gradient has reached its upper colour."""


def add_world(environment: Any, background: Any) -> None:
    """Light the scene by the environment, and show the background to the camera, also through clear bodies."""
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    graph = Graph.new(world)
    light = _panorama(graph, environment)
    if background.type in {"plain", "gradient"} or getattr(background, "blur", 0) > 0:
        path = graph.node("LightPath")
        seen = graph.math("MAXIMUM", path.outputs["Is Camera Ray"], path.outputs["Is Transmission Ray"])
        seen = graph.math("MAXIMUM", seen, graph.exhausted())
        light = graph.mix(seen, light, _backdrop(graph, background, environment))
    graph.node("OutputWorld", {"Surface": light})


def _panorama(graph: Graph, settings: Any, blur: float = 0.0) -> Any:
    """The environment's light; `blur` is the apparent diameter of a point of it [deg]."""
    if settings.strength == 0:
        return graph.node("Background", {"Strength": 0.0}).outputs[0]
    ray = graph.node("TexCoord").outputs["Generated"]
    turn = (0.0, 0.0, math.radians(settings.rotation))
    turned = graph.node("Mapping", {"Vector": ray, "Rotation": turn}).outputs[0]
    image = _load(settings)
    smooth = {"interpolation": "Cubic"} if blur > 0 else {}
    if blur > 0:
        image = images.copy(image)
        _blur(image, blur)
    color = graph.node("TexEnvironment", {"Vector": turned}, image=image, **smooth).outputs[0]
    return graph.node("Background", {"Color": color, "Strength": settings.strength}).outputs[0]


def _blur(image: Any, diameter: float) -> None:
    """Leave of a panorama one pixel for each `diameter` [deg], which a cubic spline then smooths."""
    while image.size[0] > 2 * 360 / diameter and image.size[1] > 2:
        image.scale(image.size[0] // 2, image.size[1] // 2)
    image.pack()


def _load(settings: Any) -> Any:
    file = Path(settings.file) if settings.file else _studio_light(settings.light)
    return images.load(file, "lights.environment")


def _studio_light(name: str) -> Path:
    return Path(bpy.utils.system_resource("DATAFILES", path="studiolights/world")) / f"{name}.exr"


def _backdrop(graph: Graph, settings: Any, environment: Any) -> Any:
    if settings.type == "environment":
        return _panorama(graph, environment, settings.blur)
    if settings.type == "plain":
        color = rgba(settings.color)
    else:
        ray = graph.node("TexCoord").outputs["Generated"]
        height = graph.node("SeparateXYZ", {0: ray}).outputs["Z"]
        color = graph.mix_colors(graph.ramp(height, 0.0, GRADIENT_TOP), rgba(settings.horizon), rgba(settings.zenith))
    return graph.node("Background", {"Color": color, "Strength": BACKDROP}).outputs[0]
