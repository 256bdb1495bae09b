"""The volume of each connected piece of the surface, brought to that of its particles.

A surface around particles that are farther apart than at rest encloses more than they hold: a layer that is stretched
stays as thick as it was. Vertices move along their normals until each piece has its volume, the more the fewer
particles are near: those of bulk hardly move.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from sim.bodies.wall import Wall
from workflow.stages.surface.mesh import Surface

REACH = 2.0
"""Of what is near a vertex, in spacings: the support radius of the fluid."""
PLANE = 0.5 * 4 * np.pi * 16 / 315 * REACH**3
"""Weighted number of particles near a vertex of a flat surface of bulk: half of the integral of the weight
(1 - (r / R)^2)^3 over a ball of radius R."""
LEAST = 0.02
"""Of how far vertices of thin pieces move, those of bulk do."""
INWARDS, OUTWARDS = 0.4, 0.4
"""Farthest that vertices move, in spacings: a layer is one thick."""
ON = 1e-3
"""Vertices nearer than this to a wall are on it, in spacings."""
HALVINGS = 24
"""Of the interval that the displacement of a piece is in."""


def right_volume(surface: Surface, particles: np.ndarray, spacing: float, walls: Sequence[Wall]) -> Surface:
    """The surface, each piece of which holds as much as the particles in it do, at [m], shape [n, 3], of `spacing` [m],
    as far as its vertices may move. What lies on a wall stays there, and nothing goes behind it."""
    if not len(surface.triangles) or not len(particles):
        return surface
    place = surface.vertices.astype(np.float64)
    piece, wanted = _pieces(place, surface.triangles, particles, spacing**3)
    way = _thinness(place, particles, spacing)[:, None] * _normals(surface)
    for wall in walls:
        way[wall.distance(place) < ON * spacing] = 0.0
    of_triangle = piece[surface.triangles[:, 0]]
    low, high = np.full(len(wanted), -INWARDS * spacing), np.full(len(wanted), OUTWARDS * spacing)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        enclosed = _volumes(place + middle[piece, None] * way, surface.triangles, of_triangle, len(wanted))
        more = enclosed < wanted
        low, high = np.where(more, middle, low), np.where(more, high, middle)
    place += ((low + high) / 2)[piece, None] * way
    for wall in walls:
        place, _ = wall.pressed(place)
    return replace(surface, vertices=place.astype(np.float32))


def _pieces(
    place: np.ndarray, triangles: np.ndarray, particles: np.ndarray, each: float
) -> tuple[np.ndarray, np.ndarray]:
    """The piece of each vertex, and the volume of the particles of each [m^3]. A void, which looks inwards, belongs to
    the piece around it."""
    ends = np.concatenate([triangles[:, :2], triangles[:, 1:]])
    links = coo_matrix((np.ones(len(ends), bool), (ends[:, 0], ends[:, 1])), shape=(len(place), len(place)))
    count, piece = connected_components(links, directed=False)
    solid = _volumes(place, triangles, piece[triangles[:, 0]], count) > 0
    outer = np.flatnonzero(solid[piece])
    if not len(outer):
        return piece, np.zeros(count)
    tree = KDTree(place[outer])
    voids = np.flatnonzero(~solid)
    if len(voids):
        first = np.array([np.argmax(piece == void) for void in voids])
        around = np.arange(count)
        around[voids] = piece[outer[tree.query(place[first])[1]]]
        piece = around[piece]
    held = np.bincount(piece[outer[tree.query(particles)[1]]], minlength=count)
    return piece, each * held


def _thinness(place: np.ndarray, particles: np.ndarray, spacing: float) -> np.ndarray:
    """Of vertices, from 1 far from all particles to LEAST where as many are near as at the surface of bulk."""
    radius = REACH * spacing
    near = KDTree(place).sparse_distance_matrix(KDTree(particles), radius, output_type="ndarray")
    number = np.bincount(near["i"], (1.0 - (near["v"] / radius) ** 2) ** 3, len(place))
    return np.maximum(1.0 - number / PLANE, LEAST)


def _normals(surface: Surface) -> np.ndarray:
    """Of the mesh itself: those that it is drawn with may be smoother."""
    a, b, c = np.moveaxis(surface.vertices[surface.triangles].astype(np.float64), 1, 0)
    area = np.cross(b - a, c - a)
    total = np.stack(
        [
            sum(np.bincount(surface.triangles[:, corner], area[:, axis], len(surface.vertices)) for corner in range(3))
            for axis in range(3)
        ],
        axis=1,
    )
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0, total / np.maximum(length, np.finfo(float).tiny), surface.normals)


def _volumes(place: np.ndarray, triangles: np.ndarray, piece: np.ndarray, count: int) -> np.ndarray:
    """Of each piece [m^3], by the divergence theorem."""
    a, b, c = np.moveaxis((place - place.mean(axis=0))[triangles], 1, 0)
    return np.bincount(piece, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0, count)
