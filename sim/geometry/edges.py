"""Samples behind the sharp edges and corners of a surface.

A surface at some depth below another keeps away from its edges: by that depth over the sine of half their angle, and
further from corners. What is to guard the surface has to come as near to them as to its faces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.scatter import EDGE_DISK, SHARP
from sim.geometry.thinning import first_come

if TYPE_CHECKING:
    import trimesh


ROW, CORNER = 0.9, 0.75
"""Behind an edge stands a row, behind a corner one sample alone: they come nearer by these factors to count as much as
a face at the full depth."""


@dataclass(frozen=True)
class EdgeSamples:
    """Points of sharp edges and corners."""

    points: np.ndarray
    """[m], shape [n, 3]."""
    behind: np.ndarray
    """Along the bisectors of the faces that meet, as far as a surface at unit depth keeps away, shape [n, 3]."""
    vertex: np.ndarray
    """The mesh's vertex of a corner, -1 of points between, shape [n]."""
    faces: np.ndarray
    """Two faces that meet there, shape [n, 2]."""


def on_edges(mesh: trimesh.Trimesh, spacing: float, *, convex: bool = True) -> EdgeSamples:
    """Points about `spacing` [m] apart on sharp edges that are convex, or on those that are not."""
    bulging = mesh.face_adjacency_convex if convex else ~mesh.face_adjacency_convex
    sharp = bulging & (mesh.face_adjacency_angles > SHARP)
    edges, faces = mesh.face_adjacency_edges[sharp], mesh.face_adjacency[sharp]
    if not len(edges):
        return EdgeSamples(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, int), np.zeros((0, 2), int))
    outward = _unit(mesh.face_normals[faces].sum(axis=1))
    vertices, end = np.unique(edges, return_inverse=True)
    at_vertex = np.zeros((len(vertices), 3))
    np.add.at(at_vertex, end.reshape(-1), np.repeat(outward, 2, axis=0))
    ends = np.asarray(mesh.vertices, dtype=np.float64)[edges]
    steps = np.maximum(1, np.ceil(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / spacing)).astype(int)
    edge = np.repeat(np.arange(len(edges)), steps - 1)
    share = np.concatenate([np.arange(1, number) / number for number in steps])[:, None]
    points = np.concatenate((mesh.vertices[vertices], (1 - share) * ends[edge, 0] + share * ends[edge, 1]))
    directions = np.concatenate((CORNER * _unit(at_vertex), ROW * outward[edge]))
    first = np.zeros(len(vertices), int)
    first[end.reshape(-1)] = np.repeat(np.arange(len(edges)), 2)
    vertex = np.concatenate((vertices, np.full(len(edge), -1)))
    kept = first_come(points, EDGE_DISK * spacing)
    return EdgeSamples(points[kept], directions[kept], vertex[kept], faces[np.concatenate((first, edge))][kept])


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)
