"""Textures and materials of a mended mesh: what the faces of its file have where its own are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sim.geometry.distance.closest_points import MeshDistance
from sim.geometry.triangles import MATERIAL, UV

if TYPE_CHECKING:
    import trimesh

# Share of the size within which faces have the same middle.
_APART = 1e-6
# Faces of the file that may have one middle: the two sides of a sheet, and copies.
_COPIES = 4


def of_faces(mesh: trimesh.Trimesh, file: trimesh.Trimesh) -> dict[str, np.ndarray]:
    """UV and MATERIAL of the faces of a mesh, which lies where its file does, by those of the file.

    A face has what the face of the file has that is there and looks the same way, or else the nearest. Corners that lie
    outside of that have the place of its nearest edge or corner.
    """
    corners = np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    there = np.asarray(file.vertices, dtype=np.float64)[file.faces]
    source = _sources(corners, there)
    found = {}
    if MATERIAL in file.face_attributes:
        found[MATERIAL] = np.asarray(file.face_attributes[MATERIAL])[source]
    if UV in file.face_attributes:
        weights = _weights(corners, there[source])
        found[UV] = np.einsum("fck,fki->fci", weights, np.asarray(file.face_attributes[UV])[source])
    return found


def _sources(corners: np.ndarray, there: np.ndarray) -> np.ndarray:
    """For each of the triangles `corners`, shape [m, 3, 3], the index of one of `there`."""
    import trimesh

    sound = np.flatnonzero(np.linalg.norm(_across(there), axis=1) > 0)
    whole = there[sound]
    middles, wanted = whole.mean(axis=1), corners.mean(axis=1)
    apart = _APART * float(np.ptp(wanted, axis=0).max())
    copies = min(_COPIES, len(sound))
    away, near = cKDTree(middles).query(wanted, k=copies, distance_upper_bound=apart)
    away, near = away.reshape(-1, copies), near.reshape(-1, copies)
    same = np.isfinite(away)
    alike = np.where(same, _cosine(corners[:, None], whole[np.where(same, near, 0)]), -np.inf)
    source = near[np.arange(len(near)), alike.argmax(axis=1)]
    lost = ~same.any(axis=1)
    if lost.any():
        faces = np.arange(3 * len(whole)).reshape(-1, 3)
        surface = trimesh.Trimesh(whole.reshape(-1, 3), faces, process=False)
        source[lost] = MeshDistance(surface).closest(wanted[lost])[2]
    return sound[source]


def _cosine(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of the angle between the normals of triangles, shape [..., 3, 3]."""
    a, b = _across(one), _across(other)
    length = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    return (a * b).sum(axis=-1) / np.maximum(length, 1e-300)


def _across(triangles: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(triangles, -2, 0)
    return np.cross(b - a, c - a)


def _weights(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Barycentric coordinates of points, shape [m, 3, 3], in triangles, shape [m, 3, 3]: a row each of three that are
    positive and add up to 1."""
    normal = _across(triangles)
    squared = np.maximum((normal * normal).sum(axis=1), 1e-300)
    ends, starts = np.roll(triangles, -2, axis=1), np.roll(triangles, -1, axis=1)
    # The part of the triangle's area that is opposite to each corner.
    along = (ends - starts)[:, None]
    from_start = points[:, :, None] - starts[:, None]
    share = (np.cross(along, from_start) * normal[:, None, None]).sum(axis=-1) / squared[:, None, None]
    share = np.maximum(share, 0.0)
    return share / share.sum(axis=-1, keepdims=True)
