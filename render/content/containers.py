"""Walls of the containers: their inner surface, given a thickness outwards."""

from __future__ import annotations

from typing import Any

from render.content.meshes import add_object, build_mesh
from render.content.ply import TriangleMesh

THICKNESS = 0.01
"""Of a wall over the diagonal of the box of the action, unless set."""
OVERLAP = 0.25
"""Of a wall with the water over the thickness, unless set."""
WELD = 1e-5
"""Corners nearer than this, over the same diagonal, are one: else the wall would open along its edges."""


def wall_thickness(walls: Any, size: float) -> float:
    """Thickness of drawn containers [m]."""
    return walls.thickness or THICKNESS * size


def add_container(name: str, source: TriangleMesh, walls: Any, material: Any, size: float) -> None:
    """Add a container's wall.

    It reaches a little into the water: with a film of air between them, light would be
    refracted, or thrown back, as nowhere in a real glass.
    """
    mesh = build_mesh(name, source)
    mesh.polygons.foreach_set("use_smooth", [False] * len(mesh.polygons))
    thing = add_object(name, mesh, material)
    weld = thing.modifiers.new("weld", "WELD")
    weld.merge_threshold = WELD * size
    thickness = wall_thickness(walls, size)
    overlap = OVERLAP * thickness if walls.overlap is None else walls.overlap
    wall = thing.modifiers.new("wall", "SOLIDIFY")
    wall.thickness = thickness + overlap
    wall.use_even_offset = True
    outside = (thickness - overlap) / (thickness + overlap)
    wall.offset = outside if _normals_point_outwards(mesh) else -outside


def _normals_point_outwards(mesh: Any) -> bool:
    """Whether the faces of an inner surface look away from what it holds."""
    count = len(mesh.vertices)
    center = [sum(vertex.co[axis] for vertex in mesh.vertices) / count for axis in range(3)]
    flux = 0.0
    for face in mesh.polygons:
        flux += face.area * sum(n * (c - m) for n, c, m in zip(face.normal, face.center, center, strict=True))
    return flux > 0
