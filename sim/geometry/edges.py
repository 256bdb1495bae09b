"""Samples behind the sharp edges and corners of a surface.

A surface at some depth below another keeps away from its edges: by that depth over the sine of half their angle, and
further from corners. What is to guard the surface has to come as near to them as to its faces.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.scatter import EDGE_DISK, SHARP, first_come

if TYPE_CHECKING:
    import trimesh


ROW, CORNER = 0.9, 0.75
"""Behind an edge stands a row, behind a corner one sample alone: they come nearer by these factors to count as much as
a face at the full depth."""


def behind_edges(mesh: trimesh.Trimesh, spacing: float, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] about `spacing` [m] apart and about `depth` [m] behind sharp convex edges and corners, and the points
    of the edges that they stand behind; both of shape [n, 3].

    Behind means along the bisector of the faces that meet; with a negative depth, before the sharp concave ones.
    """
    convex = mesh.face_adjacency_convex if depth > 0 else ~mesh.face_adjacency_convex
    sharp = convex & (mesh.face_adjacency_angles > SHARP)
    edges = mesh.face_adjacency_edges[sharp]
    if not len(edges):
        return np.zeros((0, 3)), np.zeros((0, 3))
    outward = _unit(mesh.face_normals[mesh.face_adjacency[sharp]].sum(axis=1))
    vertices, end = np.unique(edges, return_inverse=True)
    at_vertex = np.zeros((len(vertices), 3))
    np.add.at(at_vertex, end.reshape(-1), np.repeat(outward, 2, axis=0))
    ends = np.asarray(mesh.vertices, dtype=np.float64)[edges]
    steps = np.maximum(1, np.ceil(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / spacing)).astype(int)
    edge = np.repeat(np.arange(len(edges)), steps - 1)
    share = np.concatenate([np.arange(1, number) / number for number in steps])[:, None]
    points = np.concatenate((mesh.vertices[vertices], (1 - share) * ends[edge, 0] + share * ends[edge, 1]))
    directions = np.concatenate((CORNER * _unit(at_vertex), ROW * outward[edge]))
    kept = first_come(points, EDGE_DISK * spacing)
    return points[kept] - depth * directions[kept], points[kept]


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)
