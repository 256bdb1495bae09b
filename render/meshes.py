"""Blender meshes from what `ply` reads."""

from __future__ import annotations

import math
from array import array
from typing import Any

from render.axes import z_up_columns
from render.blender import bpy
from render.nodes import TINT, rgba
from render.ply import TriangleMesh

SHARP_ANGLE = math.radians(35)
"""Faces of a solid body that meet at more than this show an edge."""

COLOR_COLUMNS = ("red", "green", "blue")


def build_mesh(name: str, source: TriangleMesh) -> Any:
    """A smooth-shaded bpy mesh, z up.

    Velocities [m/s] become the point attribute `velocity`: Cycles takes it, under this very name, for motion blur.
    Colours become the point attribute TINT.
    """
    columns, triangles = source.columns, source.triangles
    mesh = bpy.data.meshes.new(name)
    faces = len(triangles) // 3
    if faces == 0:
        return mesh
    mesh.vertices.add(source.vertex_count())
    mesh.vertices.foreach_set("co", z_up_columns(columns["x"], columns["y"], columns["z"]))
    mesh.loops.add(3 * faces)
    mesh.loops.foreach_set("vertex_index", triangles)
    mesh.polygons.add(faces)
    mesh.polygons.foreach_set("loop_start", array("i", range(0, 3 * faces, 3)))
    if bpy.app.version < (4, 1, 0):
        mesh.polygons.foreach_set("loop_total", array("i", [3]) * faces)
    mesh.polygons.foreach_set("use_smooth", array("b", [1]) * faces)
    if source.has("vx", "vy", "vz"):
        velocity = mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
        velocity.data.foreach_set("vector", z_up_columns(columns["vx"], columns["vy"], columns["vz"]))
    if source.has(*COLOR_COLUMNS):
        tint = mesh.attributes.new(TINT, "FLOAT_COLOR", "POINT")
        tint.data.foreach_set("color", _light(*(columns[name] for name in COLOR_COLUMNS)))
    mesh.update(calc_edges=True)
    return mesh


def _light(*channels: Any) -> array:
    """Columns of red, green and blue from 0 to 255 (sRGB) to one flat buffer of linear colours with full opacity."""
    flat = array("f")
    for color in zip(*channels, strict=True):
        flat.extend(rgba([channel / 255 for channel in color]))
    return flat


def sharpen(mesh: Any) -> None:
    """Show the edges of a solid body, and keep its curved faces smooth."""
    if hasattr(mesh, "set_sharp_from_angle"):
        mesh.set_sharp_from_angle(angle=SHARP_ANGLE)
    else:
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = SHARP_ANGLE


def add_object(name: str, mesh: Any, material: Any) -> Any:
    """Put a mesh into the scene."""
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    dress(thing, material)
    return thing


def dress(thing: Any, material: Any) -> None:
    """Give an object its material, whatever mesh it has next: the slot belongs to the object."""
    if not thing.data.materials:
        thing.data.materials.append(None)
    thing.material_slots[0].link = "OBJECT"
    thing.material_slots[0].material = material


def replace_mesh(thing: Any, mesh: Any, material: Any) -> None:
    """Exchange an object's mesh and free the old one."""
    old = thing.data
    thing.data = mesh
    bpy.data.meshes.remove(old)
    dress(thing, material)
