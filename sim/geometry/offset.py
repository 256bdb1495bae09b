"""A surface moved along its normals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import trimesh

_REGULARISATION = 0.02
"""Share of the identity in the normal equations: keeps flat and smooth places from sliding sideways."""
_LONGEST = 2.0
"""A vertex at a sharp spike moves at most this many times the distance."""


def inset(mesh: trimesh.Trimesh, distance: float) -> trimesh.Trimesh:
    """The mesh with every face moved `distance` [m] inward (outward where negative), topology unchanged.

    A vertex moves by the d that fits n.d = -distance for the normals n of all its faces in the sense of least squares,
    weighted by their angles: corners of a box stay corners. Parts thinner than twice the distance cross.
    """
    import trimesh

    normals = np.repeat(mesh.face_normals, 3, axis=0)
    weights = mesh.face_angles.reshape(-1)
    vertex = mesh.faces.reshape(-1)
    outer = weights[:, None, None] * normals[:, :, None] * normals[:, None, :]
    matrix = np.zeros((len(mesh.vertices), 3, 3))
    right = np.zeros((len(mesh.vertices), 3))
    np.add.at(matrix, vertex, outer)
    np.add.at(right, vertex, weights[:, None] * normals)
    scale = np.trace(matrix, axis1=1, axis2=2)[:, None, None]
    matrix += (_REGULARISATION * np.maximum(scale, 1e-12)) * np.eye(3)
    move = np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
    # The identity shortens moves; with the best factor a plane, an edge and the corner of a box move exactly.
    reached = weights * (normals * move[vertex]).sum(axis=1)
    square = reached * (normals * move[vertex]).sum(axis=1)
    total = np.bincount(vertex, square, minlength=len(move))
    move *= (np.bincount(vertex, reached, minlength=len(move)) / np.maximum(total, 1e-300))[:, None]
    length = np.linalg.norm(move, axis=1, keepdims=True)
    move *= np.minimum(1.0, _LONGEST / np.maximum(length, 1e-12))
    return trimesh.Trimesh(mesh.vertices - distance * move, mesh.faces, process=False)
