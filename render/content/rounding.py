"""Rounded edges of bodies: no edge of a real thing is sharp, and light catches on it."""

from __future__ import annotations

import math
from typing import Any

import bmesh
from mathutils import Vector

from render.blender import versions
from render.content.meshes import SHARP_ANGLE
from render.content.nodes import TINT

SEGMENTS = 3
"""Faces across a rounded edge."""
FLAT = math.radians(0.1)
"""Triangles that meet at less than this are parts of one flat face."""


def round_edges(mesh: Any, radius: float) -> None:
    """Round the edges of a solid by a radius [m], or by as much as its faces have room for, and shade flat faces flat
    up to there."""
    solid = bmesh.new()
    solid.from_mesh(mesh)
    if TINT not in mesh.attributes:  # a flat face that is made one loses the colours of the vertices within it
        kept_apart = {"MATERIAL", "UV"}
        bmesh.ops.dissolve_limit(solid, angle_limit=FLAT, verts=solid.verts, edges=solid.edges, delimit=kept_apart)
    edges = [edge for edge in solid.edges if edge.is_manifold and edge.calc_face_angle() > SHARP_ANGLE]
    shape = {"offset_type": "OFFSET", "segments": SEGMENTS, "profile": 0.5, "clamp_overlap": True}
    made = bmesh.ops.bevel(solid, geom=edges, affect="EDGES", offset=radius, **shape)
    rounded = set(made["faces"])
    solid.normal_update()
    normals = [_normal(vertex, rounded) for vertex in solid.verts]
    for part in (*solid.faces, *solid.edges):
        part.smooth = True
    solid.to_mesh(mesh)
    solid.free()
    versions.set_normals(mesh, normals)


def _normal(vertex: Any, rounded: set[Any]) -> Vector:
    """Of the faces that were there before the edges were rounded, where it touches one; each counts by its angle."""
    corners = [loop for loop in vertex.link_loops if loop.face not in rounded] or list(vertex.link_loops)
    total = sum((loop.calc_angle() * loop.face.normal for loop in corners), Vector())
    return total.normalized() if total.length > 0 else vertex.normal
