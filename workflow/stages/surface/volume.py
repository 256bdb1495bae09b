"""The volume of each connected piece of the surface, brought to that of its particles.

A surface around particles that are farther apart than at rest encloses more than they hold: a layer that is stretched
stays as thick as it was. Vertices move along their normals until each piece has its volume, the more the fewer
particles are near: those of bulk hardly move. How many are near is smoothed along the surface, or what is left of the
bumps of single particles would be carved out of it again.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from workflow.stages.surface.boundary import Boundary
from workflow.stages.surface.mesh import Smoothing, Surface, area_normals, unit_normals, volumes

REACH, NEAREST = 2.0, 12
"""Of what is near a vertex, in spacings: the support radius of the fluid; and in particles: more are no sheet."""
PLANE = 0.5 * 4 * np.pi * 16 / 315 * REACH**3
"""Weighted number of particles near a vertex of a flat surface of bulk: half of the integral of the weight
(1 - (r / R)^2)^3 over a ball of radius R."""
LEAST = 0.1
"""Of how far vertices far from all particles move, those of bulk do."""
FARTHEST = 0.48
"""That a vertex moves, in spacings: a layer is one thick, and has two sides."""
SHARE = 0.9
"""Of its distance from a wall that a vertex of a film on it may move: a film has one side."""
ROUNDS = 60
"""Of the mean over neighbours along the surface that smooths how thin it is: the square root of it are edges."""
MOST = FARTHEST / LEAST
"""How far vertices far from all particles would move, in spacings, when those of bulk move as far as they may."""
SOLID = 0.05
"""Pieces of less volume, in particles, are voids or splinters, and belong to the piece around them."""
ENOUGH = 2e-3
"""Of the volume of a piece that may be left wrong."""
TRIES = 12
"""To find how far its vertices move."""


def right_volume(
    surface: Surface, on: np.ndarray, particles: np.ndarray, boundary: Boundary, rounds: int = 10
) -> Surface:
    """The surface, each piece of which holds as much as the particles in it do, at [m], shape [n, 3], as far as its
    vertices may move. Those `on` the boundary of the particles stay there, and nothing goes behind it. Normals turn as
    much as those of the mesh do, smoothed by `rounds` of the mean over neighbours."""
    if not len(surface.triangles) or not len(particles):
        return surface
    piece, wanted = _pieces(surface, particles, boundary.spacing**3)
    around, _ = boundary.continued((particles, np.zeros_like(particles)))
    smoothing = Smoothing(surface.triangles, len(surface.vertices))
    thin = smoothing.mean(_thinness(surface.vertices, around, boundary.spacing), ROUNDS)
    area = area_normals(surface.vertices, surface.triangles)
    found = _filled(surface, area, piece, wanted, np.where(on, 0.0, thin), boundary)
    after = unit_normals(found, area_normals(found.vertices, found.triangles))
    turned = np.where(on[:, None], 0.0, after - unit_normals(surface, area))
    normals = surface.normals + smoothing.mean(turned, rounds)
    length = np.linalg.norm(normals, axis=1)
    kept = on | (length == 0)
    normals /= np.where(kept, 1.0, length)[:, None]
    return replace(found, normals=np.where(kept[:, None], surface.normals, normals).astype(np.float32))


def right_drops(drops: Surface, on: np.ndarray, drop: np.ndarray, volumes: np.ndarray, boundary: Boundary) -> Surface:
    """The surface of drops of `volumes` [m^3], of which walls have cut off some; which of its vertices are `on` these,
    and the `drop` of each."""
    cut = np.zeros(len(volumes), bool)
    cut[drop[on]] = True
    if not cut.any():
        return drops
    some, number = cut[drop], np.cumsum(cut[drop]) - 1
    triangles = number[drops.triangles[some[drops.triangles[:, 0]]]].astype(np.int32)
    part = Surface(drops.vertices[some], drops.normals[some], drops.velocities[some], triangles)
    thin = np.where(on[some], 0.0, 1.0)
    vertices = drops.vertices.copy()
    area = area_normals(part.vertices, part.triangles)
    vertices[some] = _filled(part, area, (np.cumsum(cut) - 1)[drop[some]], volumes[cut], thin, boundary).vertices
    return replace(drops, vertices=vertices)


def _filled(
    surface: Surface, area: np.ndarray, piece: np.ndarray, wanted: np.ndarray, thin: np.ndarray, boundary: Boundary
) -> Surface:
    """The surface, whose area normals are `area` [m^2], with each piece of the volume wanted [m^3]: vertices move by
    as much as each is thin, found by secants, the first by the area that moves, within what is known to be too little
    and too much."""
    place, normal, spacing = surface.vertices.astype(np.float64), unit_normals(surface, area), boundary.spacing
    size = np.linalg.norm(area, axis=1)
    height = boundary.heights(surface, normal, 2 * spacing)
    # less again above a film, as far as free surfaces two spacings from the wall
    film = np.where(height < spacing, SHARE * height, SHARE * spacing - FARTHEST * (height - spacing))
    inwards = np.where(np.isfinite(height), film, FARTHEST * spacing)
    outwards = np.minimum(FARTHEST * spacing, boundary.heights(surface, -normal, spacing))
    of_triangle, count = piece[surface.triangles[:, 0]], len(wanted)

    def moved(far: np.ndarray) -> np.ndarray:
        """Where vertices are, if those of each piece that are far from all particles move as far [m]."""
        step = np.clip(far[piece] * thin, -inwards, outwards)
        return boundary.pressed(place + step[:, None] * normal)

    def too_much(far: np.ndarray) -> np.ndarray:
        """Over what is wanted; pieces that are none have what they want."""
        found = volumes(moved(far), surface.triangles, of_triangle, count)
        return np.where(wanted > 0, found - wanted, 0.0)

    low, high = np.full(count, -MOST * spacing), np.full(count, MOST * spacing)
    far, now = np.zeros(count), too_much(np.zeros(count))
    slope = np.bincount(piece, size * thin, count)
    best, error = far, np.abs(now)
    for _ in range(TRIES):
        if not (error > ENOUGH * wanted).any():
            break
        low, high = np.where(now < 0, far, low), np.where(now > 0, far, high)
        there = far - np.divide(now, slope, out=np.full(count, np.inf), where=slope > 0)
        inside = (there > low) & (there < high)
        there = np.where(error > ENOUGH * wanted, np.where(inside, there, (low + high) / 2), best)
        then = too_much(there)
        slope = np.divide(then - now, there - far, out=slope, where=there != far)
        far, now = there, then
        better = np.abs(now) < error
        best, error = np.where(better, far, best), np.where(better, np.abs(now), error)
    return replace(surface, vertices=moved(best).astype(np.float32))


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
