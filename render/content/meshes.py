"""Blender meshes from what `ply` reads."""

from __future__ import annotations

import math
from array import array
from typing import Any

from common.attributes import FOAM, WET, attributes_among
from render.blender import versions
from render.blender.session import bpy
from render.content.axes import z_up_columns
from render.content.nodes import TINT, rgba
from render.content.ply import TriangleMesh

SHARP_ANGLE = math.radians(35)
"""Faces of a solid body that meet at more than this show an edge."""

COLOR_COLUMNS = ("red", "green", "blue")
NORMAL_COLUMNS = ("nx", "ny", "nz")
SAME = 1e-9
"""One minus the cosine between directions that are the same up to rounding."""


def build_mesh(name: str, source: TriangleMesh) -> Any:
    """A smooth-shaded bpy mesh, z up, with an edge where fluid ends at a wall.

    Velocities [m/s] become the point attribute `velocity`: Cycles takes it, under this very name, for motion blur.
    Colours become the point attribute TINT; what water says of the fluid, one of the same name each.
    """
    source = _parted_at_walls(source)
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
    versions.count_corners(mesh, faces)
    mesh.polygons.foreach_set("use_smooth", array("b", [1]) * faces)
    if source.has("vx", "vy", "vz"):
        velocity = mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
        velocity.data.foreach_set("vector", z_up_columns(columns["vx"], columns["vy"], columns["vz"]))
    if source.has(*COLOR_COLUMNS):
        tint = mesh.attributes.new(TINT, "FLOAT_COLOR", "POINT")
        tint.data.foreach_set("color", _light(*(columns[name] for name in COLOR_COLUMNS)))
    for name in (*attributes_among(source.columns), *filter(source.has, (FOAM, WET))):
        mesh.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", source.columns[name])
    mesh.update(calc_edges=True)
    return mesh


def _parted_at_walls(source: TriangleMesh) -> TriangleMesh:
    """The same mesh with corners of their own for triangles that look just where a corner does, by the normals of the
    file: fluid flush with a wall, which smooth shading would round at its edge. Triangles without area are left out.

    Edges marked sharp would do the same, but the shadows of what is clear are then dark (Blender 4.5).
    """
    if isinstance(source.triangles, array) or not source.has(*NORMAL_COLUMNS):
        return source
    import numpy as np

    place, normal = (
        np.stack([source.columns[name] for name in names], axis=1).astype(np.float64)
        for names in ("xyz", NORMAL_COLUMNS)
    )
    triangles = np.asarray(source.triangles).reshape(-1, 3)
    corner = place[triangles]
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(across, axis=1)
    triangles, across, area = triangles[area > 0], across[area > 0], area[area > 0]
    cosine = np.einsum("ij,ikj->ik", across / area[:, None], normal[triangles]).max(axis=1, initial=0.0)
    flat = cosine > 1 - SAME
    count = source.vertex_count()
    corners = np.concatenate([np.arange(count), triangles[flat].ravel()])
    triangles[flat] = np.arange(count, len(corners)).reshape(-1, 3)
    return TriangleMesh({name: column[corners] for name, column in source.columns.items()}, triangles.ravel())


def _light(*channels: Any) -> array:
    """Columns of red, green and blue from 0 to 255 (sRGB) to one flat buffer of linear colours with full opacity."""
    flat = array("f")
    for color in zip(*channels, strict=True):
        flat.extend(rgba([channel / 255 for channel in color]))
    return flat


def lay(mesh: Any, uv: Any) -> None:
    """Say where in images the corners of triangles are, flat [6 m]; nothing for None."""
    if uv is not None and len(mesh.polygons):
        versions.set_uv(mesh.uv_layers.new(name="UVMap"), uv)


def divide(mesh: Any, material: Any, count: int) -> None:
    """Say which of `count` materials each triangle has, the last where it has none of its own; shape [m]."""
    last = count - 1
    mesh.polygons.foreach_set("material_index", array("i", (n if 0 <= n < last else last for n in material.tolist())))


def sharpen(mesh: Any) -> None:
    """Show the edges of a solid body, and keep its curved faces smooth."""
    versions.show_edges(mesh, SHARP_ANGLE)


def add_object(name: str, mesh: Any, *materials: Any) -> Any:
    """Put a mesh into the scene; its faces have the first of the materials, unless they are divided among them."""
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    dress(thing, *materials)
    return thing


def dress(thing: Any, *materials: Any) -> None:
    """Give an object its materials, whatever mesh it has next: the slots belong to the object."""
    while len(thing.data.materials) < len(materials):
        thing.data.materials.append(None)
    for slot, material in zip(thing.material_slots, materials, strict=False):
        slot.link = "OBJECT"
        slot.material = material


def replace_mesh(thing: Any, mesh: Any, *materials: Any) -> None:
    """Exchange an object's mesh and free the old one."""
    old = thing.data
    thing.data = mesh
    bpy.data.meshes.remove(old)
    dress(thing, *materials)
