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
from workflow.stages.surface.mesh import Surface, volumes
from workflow.stages.surface.walls import continued

REACH, NEAREST = 2.0, 12
"""Of what is near a vertex, in spacings: the support radius of the fluid; and in particles: more are no sheet."""
PLANE = 0.5 * 4 * np.pi * 16 / 315 * REACH**3
"""Weighted number of particles near a vertex of a flat surface of bulk: half of the integral of the weight
(1 - (r / R)^2)^3 over a ball of radius R."""
LEAST = 0.1
"""Of how far vertices far from all particles move, those of bulk do."""
FARTHEST = 0.45
"""That a vertex moves, in spacings: a layer is one thick."""
MOST = 2.0
"""How far vertices far from all particles would move, in spacings."""
SOLID = 0.05
"""Pieces of less volume, in particles, are voids or splinters, and belong to the piece around them."""
ON = 1e-3
"""Vertices nearer than this to a wall are on it, in spacings."""
ENOUGH = 2e-3
"""Of the volume of a piece that may be left wrong."""
TRIES = 12
"""To find how far its vertices move."""


def right_volume(surface: Surface, particles: np.ndarray, spacing: float, walls: Sequence[Wall]) -> Surface:
    """The surface, each piece of which holds as much as the particles in it do, at [m], shape [n, 3], of `spacing` [m],
    as far as its vertices may move. What lies on a wall stays there, and nothing goes behind it."""
    if not len(surface.triangles) or not len(particles):
        return surface
    piece, wanted = _pieces(surface, particles, spacing**3)
    around, _ = continued((particles, np.zeros_like(particles)), spacing, walls)
    return _filled(surface, piece, wanted, _thinness(surface.vertices, around, spacing), spacing, walls)


def right_drops(drops: Surface, count: int, spacing: float, walls: Sequence[Wall]) -> Surface:
    """The surface of so many balls of one particle each, of which walls have cut off some."""
    if not count or not walls:
        return drops
    piece = np.repeat(np.arange(count), len(drops.vertices) // count)
    return _filled(drops, piece, np.full(count, spacing**3), np.ones(len(drops.vertices)), spacing, walls)


def _filled(
    surface: Surface, piece: np.ndarray, wanted: np.ndarray, thin: np.ndarray, spacing: float, walls: Sequence[Wall]
) -> Surface:
    """The surface, each piece of which has the volume wanted [m^3]: its vertices move by as much as each is thin, by
    regula falsi after the Illinois method (Dowell & Jarratt 1971), with the end that stays halved each time."""
    place, normal = surface.vertices.astype(np.float64), _normals(surface)
    of_triangle, count = piece[surface.triangles[:, 0]], len(wanted)
    for wall in walls:
        thin = np.where(wall.distance(place) < ON * spacing, 0.0, thin)

    def moved(far: np.ndarray) -> np.ndarray:
        """Where vertices are, if those of each piece that are far from all particles move as far [m]."""
        step = np.clip(far[piece] * thin, -FARTHEST * spacing, FARTHEST * spacing)
        there = place + step[:, None] * normal
        for wall in walls:
            there, _ = wall.pressed(there)
        return there

    def too_much(far: np.ndarray) -> np.ndarray:
        """Over what is wanted; pieces that are none have what they want."""
        found = volumes(moved(far), surface.triangles, of_triangle, count)
        return np.where(wanted > 0, found / np.where(wanted > 0, wanted, 1.0) - 1.0, 0.0)

    low, high = np.full(count, -MOST * spacing), np.full(count, MOST * spacing)
    far = np.zeros(count)
    now, at_low, at_high = too_much(far), too_much(low), too_much(high)
    for _ in range(TRIES):
        open_ = (np.abs(now) > ENOUGH) & (at_low < 0) & (at_high > 0)
        if not open_.any():
            break
        above = now > 0
        at_high = np.where(above, now, at_high / 2)
        at_low = np.where(above, at_low / 2, now)
        low, high = np.where(above, low, far), np.where(above, far, high)
        far = np.where(open_, (low * at_high - high * at_low) / np.where(open_, at_high - at_low, 1.0), far)
        now = too_much(far)
    far = np.where(at_low >= 0, low, np.where(at_high <= 0, high, far))
    return replace(surface, vertices=moved(far).astype(np.float32))


def _pieces(surface: Surface, particles: np.ndarray, each: float) -> tuple[np.ndarray, np.ndarray]:
    """The piece of each vertex, and the volume of the particles of each [m^3], `each` of one. A void, which looks
    inwards, belongs to the piece around it."""
    place, triangles = surface.vertices.astype(np.float64), surface.triangles
    ends = np.concatenate([triangles[:, :2], triangles[:, 1:]])
    links = coo_matrix((np.ones(len(ends), bool), (ends[:, 0], ends[:, 1])), shape=(len(place), len(place)))
    count, piece = connected_components(links, directed=False)
    solid = volumes(place, triangles, piece[triangles[:, 0]], count) > SOLID * each
    outer = np.flatnonzero(solid[piece])
    if not len(outer):
        return piece, np.zeros(count)
    tree = KDTree(place[outer])
    first = np.zeros(count, int)
    first[piece[::-1]] = np.arange(len(piece))[::-1]
    around = np.where(solid, np.arange(count), piece[outer[tree.query(place[first])[1]]])
    piece = around[piece]
    held = np.bincount(piece[outer[tree.query(particles)[1]]], minlength=count)
    return piece, each * held


def _thinness(place: np.ndarray, particles: np.ndarray, spacing: float) -> np.ndarray:
    """Of vertices, from 1 far from all particles to LEAST where as many are near as at the surface of bulk."""
    radius = REACH * spacing
    away, _ = KDTree(particles).query(place, NEAREST, distance_upper_bound=radius)
    number = ((1.0 - np.minimum(away / radius, 1.0) ** 2) ** 3).sum(axis=1)
    return np.maximum(1.0 - number / PLANE, LEAST)


def _normals(surface: Surface) -> np.ndarray:
    """Of the mesh itself: those that it is drawn with may be smoother."""
    a, b, c = np.moveaxis(surface.vertices[surface.triangles].astype(np.float64), 1, 0)
    area = np.cross(b - a, c - a)
    corners, number = surface.triangles.ravel(), len(surface.vertices)
    total = np.stack([np.bincount(corners, np.repeat(area[:, axis], 3), number) for axis in range(3)], axis=1)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0, total / np.maximum(length, np.finfo(float).tiny), surface.normals)
