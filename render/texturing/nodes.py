"""What images give to a material, as nodes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from render.content.nodes import Graph
from render.content.ply import TriangleMesh
from render.errors import Unusable
from render.texturing.images import load
from render.texturing.projection import project

EXTENSIONS = {"repeat": "REPEAT", "mirror": "MIRROR", "extend": "EXTEND"}
"""What is beyond the edges of an image, as Blender calls it."""
INPUTS = {"texture": ("Base Color", "Color"), "roughness_map": ("Roughness",), "normal_map": ("Normal",)}
"""The settings of a look that name images, and the inputs of shaders that take them."""
COLORS = ("texture", "base_map", "alpha_map", "emission_map")
SHADERS = ("BSDF_PRINCIPLED", "BSDF_DIFFUSE")


def places(name: str, source: TriangleMesh, look: Any, size: float | None = None) -> Any:
    """Where images lie on a mesh: UV at its corners, flat [6 m], as its file has them or the look wants it; None where
    there is neither. `size` is as in `project`. Raises Unusable for images that are none, and as `project` does."""
    named = _images(look)
    if not named:
        return project(source, look, 1.0) if look.type == "imported" else source.uv
    width, height = _load(name, *next(iter(named.items()))).size
    try:
        return project(source, look, height / width, size)
    except Unusable as error:
        raise Unusable(f"materials.{name}.{error}") from None


def _images(look: Any) -> dict[str, str]:
    """The images of a look by their settings; those of other packages have settings of their own."""
    if getattr(look, "build", None) or look.type == "imported":
        return {}
    found = ((setting, getattr(look, setting, None)) for setting in INPUTS)
    return {setting: file for setting, file in found if file}


def put_images(graph: Graph, name: str, look: Any) -> None:
    """Have the images of a look stand in for what its shaders had there; raises Unusable for those that are none."""
    for setting, file in _images(look).items():
        color = graph.node("TexImage", image=_load(name, setting, file)).outputs["Color"]
        if setting == "normal_map":
            color = graph.node("NormalMap", {"Color": color}).outputs[0]
        graph.feed_shaders(SHADERS, INPUTS[setting], color)


def imported_image(graph: Graph, name: str, setting: str, image: Any) -> Any:
    """The node of an image of an imported material; raises Unusable for one that is none."""
    # Of opacity one channel is a number, like that of roughness.
    data = setting not in COLORS or image.channel is not None
    node = graph.node("TexImage", image=_load(name, setting, image.file, image.image, data))
    node.extension = EXTENSIONS[image.wrap]
    scale, offset = tuple(image.scale), tuple(image.offset)
    if (scale, offset, image.rotation) != ((1.0, 1.0), (0.0, 0.0), 0.0):
        inputs = {
            "Vector": graph.node("TexCoord").outputs["UV"],
            "Location": (*offset, 0.0),
            "Rotation": (0.0, 0.0, math.radians(image.rotation)),
            "Scale": (*scale, 1.0),
        }
        graph.feed(node, "Vector", graph.node("Mapping", inputs).outputs[0])
    return node


def _load(name: str, setting: str, file: str, index: int | None = None, data: bool | None = None) -> Any:
    """`data` are plain numbers, which all are but colours."""
    plain = setting not in COLORS if data is None else data
    return load(Path(file), f"materials.{name}.{setting}", index, data=plain)
