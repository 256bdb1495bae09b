"""Points of the sharp edges and corners of a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.thinning import first_come

if TYPE_CHECKING:
    import trimesh

SHARP = np.deg2rad(40.0)
"""Faces meet in a sharp edge that are turned by more than this."""
APART = 0.75
"""Closest that points of sharp edges may come, over the spacing."""


@dataclass(frozen=True)
class EdgePoints:
    """Points of sharp edges and corners."""

    points: np.ndarray
    """[m], shape [n, 3]."""
    vertex: np.ndarray
    """The mesh's vertex of a corner, -1 of points between, shape [n]."""
    faces: np.ndarray
    """Two faces that meet there, shape [n, 2]."""


def on_edges(mesh: trimesh.Trimesh, spacing: float) -> EdgePoints:
    """Points about `spacing` [m] apart on sharp edges that bulge."""
    sharp = mesh.face_adjacency_convex & (mesh.face_adjacency_angles > SHARP)
    edges, faces = mesh.face_adjacency_edges[sharp], mesh.face_adjacency[sharp]
    if not len(edges):
        return EdgePoints(np.zeros((0, 3)), np.zeros(0, int), np.zeros((0, 2), int))
    vertices, end = np.unique(edges, return_inverse=True)
    ends = np.asarray(mesh.vertices, dtype=np.float64)[edges]
    steps = np.maximum(1, np.ceil(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / spacing)).astype(int)
    edge = np.repeat(np.arange(len(edges)), steps - 1)
    share = np.concatenate([np.arange(1, number) / number for number in steps])[:, None]
    points = np.concatenate((mesh.vertices[vertices], (1 - share) * ends[edge, 0] + share * ends[edge, 1]))
    first = np.zeros(len(vertices), int)
    first[end.reshape(-1)] = np.repeat(np.arange(len(edges)), 2)
    vertex = np.concatenate((vertices, np.full(len(edge), -1)))
    kept = first_come(points, APART * spacing)
    return EdgePoints(points[kept], vertex[kept], faces[np.concatenate((first, edge))][kept])
