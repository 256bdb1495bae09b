"""Which ways a surface faces at its faces, edges and vertices: cones of directions.

A cone is a row of its axis and the cosine of its half angle; with a cosine of -1 it holds every direction.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.meshes.edges import SHARP

if TYPE_CHECKING:
    import trimesh

ANY = (0.0, 1.0, 0.0, -1.0)
ROUND = np.radians(15)
"""A surface that turns by less at a place, but turns, is taken for round there: what it touches decides, within this
angle, where it faces. A facet that comes down on a flat face would push against its slope before its corner lands."""
_FLAT = np.radians(0.1)
"""Below this angle it does not turn."""
_NEEDLE = 1e-9
"""Height over the longest edge below which the direction of a triangle is rounding."""


def of_faces(mesh: trimesh.Trimesh) -> np.ndarray:
    """Unit normals with the cosine 1, shape [faces, 4]."""
    corners = np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    found = np.ones((len(normal), 4))
    found[:, :3] = normal / np.maximum(length, 1e-300)[:, None]
    found[length <= _NEEDLE * longest**2] = ANY
    return found


def smooth(mesh: trimesh.Trimesh) -> np.ndarray:
    """Cones of faces that hold the normals of those which go on smoothly from them, shape [faces, 4]."""
    found = of_faces(mesh)
    pairs = mesh.face_adjacency[mesh.face_adjacency_angles <= SHARP]
    along = (found[pairs[:, 0], :3] * found[pairs[:, 1], :3]).sum(axis=1)
    known = (found[pairs, 3] > 0).all(axis=1)
    for side in range(2):
        np.minimum.at(found[:, 3], pairs[known, side], along[known])
    return found


def rounded(cones: np.ndarray) -> np.ndarray:
    """The same cones, but as wide as ROUND where the surface is round; shape [n, 4]."""
    turns = (cones[:, 3] < np.cos(_FLAT)) & (cones[:, 3] > np.cos(ROUND))
    return np.column_stack([cones[:, :3], np.where(turns, np.cos(ROUND), cones[:, 3])])


def of_edges(mesh: trimesh.Trimesh, faces: np.ndarray) -> np.ndarray:
    """Cones of edges between two faces each, shape [n, 2]; shape [n, 4]."""
    flat = of_faces(mesh)[faces].reshape(-1, 4)
    return _around(flat, np.arange(len(flat)) // 2, np.ones(len(flat)), len(faces))


def of_vertices(mesh: trimesh.Trimesh) -> np.ndarray:
    """Cones of all vertices, around the mean by angle of the normals that meet; shape [vertices, 4]."""
    flat = np.repeat(of_faces(mesh), 3, axis=0)
    return _around(flat, mesh.faces.reshape(-1), np.asarray(mesh.face_angles).reshape(-1), len(mesh.vertices))


def _around(faces: np.ndarray, at: np.ndarray, weight: np.ndarray, number: int) -> np.ndarray:
    """The cones at `number` places of faces, each of which is `at` one of them."""
    known = faces[:, 3] > 0
    faces, at, weight = faces[known, :3], at[known], weight[known]
    found = np.zeros((number, 4))
    np.add.at(found[:, :3], at, weight[:, None] * faces)
    found[:, :3] /= np.maximum(np.linalg.norm(found[:, :3], axis=1, keepdims=True), 1e-300)
    found[:, 3] = np.where(found[:, :3].any(axis=1), 1.0, -1.0)
    np.minimum.at(found[:, 3], at, (found[at, :3] * faces).sum(axis=1))
    # Half a sphere and more tells nothing.
    found[found[:, 3] <= 0] = ANY
    return found
