"""Images on what shows the look of the ground."""

from __future__ import annotations

from array import array
from typing import Any

from render.blender import versions
from render.content.ply import TriangleMesh
from render.texturing.nodes import places


def lay_images(thing: Any, look: Any, size: float) -> None:
    """Lay the images of the ground's look on an object, as from a box, around its middle; nothing where there are
    none. They are `size` [m] wide, unless the look says how wide."""
    mesh = thing.data
    mesh.calc_loop_triangles()
    at = [vertex.co for vertex in mesh.vertices]
    y_up = {"x": (p.x for p in at), "y": (p.z for p in at), "z": (-p.y for p in at)}
    triangles = array("i", (vertex for part in mesh.loop_triangles for vertex in part.vertices))
    columns = {name: array("f", column) for name, column in y_up.items()}
    uv = places("ground", TriangleMesh(columns, triangles), look, size)
    if uv is None:
        return
    flat = array("f", bytes(8 * len(mesh.loops)))
    corners = (corner for part in mesh.loop_triangles for corner in part.loops)
    for index, corner in enumerate(corners):
        flat[2 * corner : 2 * corner + 2] = uv[2 * index : 2 * index + 2]
    versions.set_uv(mesh.uv_layers.new(name="UVMap"), flat)
