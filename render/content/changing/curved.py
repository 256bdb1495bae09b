"""Curved triangles, by the directions at their corners: cloth bends within a triangle of the simulation, too."""

from __future__ import annotations

from array import array
from typing import Any

from render.content.ply import TriangleMesh


def curved(source: TriangleMesh) -> TriangleMesh:
    """The same surface with each triangle in four.

    Corners stay where they are, and the middle of an edge lies on the cubic that leaves both its ends at right angles
    to the normals there (curved PN triangles, Vlachos et al. 2001). What else vertices have is the mean of the two
    ends. Without NumPy, triangles stay flat.
    """
    if isinstance(source.triangles, array) or source.vertex_count() == 0:
        return source
    import numpy as np

    place = np.stack([source.columns[axis] for axis in "xyz"], axis=1).astype(np.float64)
    triangles = np.asarray(source.triangles).reshape(-1, 3)
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, of_sides = np.unique(sides, axis=0, return_inverse=True)
    first, second = edges.T
    normal = _normals(place, triangles)
    along = place[second] - place[first]
    rise = (along * normal[first]).sum(axis=1), -(along * normal[second]).sum(axis=1)
    bulge = -(rise[0][:, None] * normal[first] + rise[1][:, None] * normal[second]) / 8

    bulges = dict(zip("xyz", bulge.T, strict=True))

    def divided(name: str, column: Any) -> Any:
        values = np.asarray(column)
        middle = (values[first] + values[second]) / 2 + bulges.get(name, 0)
        return np.concatenate([values, middle.astype(values.dtype)])

    columns = {name: divided(name, column) for name, column in source.columns.items()}
    middles = of_sides.reshape(-1, 3) + len(place)
    (a, b, c), (ab, bc, ca) = triangles.T, middles.T
    parts = np.stack([(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)])  # [4, 3, m]
    return TriangleMesh(columns, parts.transpose(2, 0, 1).astype(triangles.dtype).ravel())


def _normals(place: Any, triangles: Any) -> Any:
    """At vertices [n, 3], of unit length: those of the triangles around, by their areas."""
    import numpy as np

    a, b, c = place[triangles].transpose(1, 0, 2)
    across = np.cross(b - a, c - a)
    normal = np.zeros_like(place)
    for corner in range(3):
        np.add.at(normal, triangles[:, corner], across)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return normal / np.where(length > 0, length, 1.0)
