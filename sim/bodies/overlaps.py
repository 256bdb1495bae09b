"""Which bodies are placed inside each other, found before anything is built that steps."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence

import numpy as np

from sim.bodies.obstacles import Obstacle, Obstacles
from sim.geometry.distance.closest_points import cover
from sim.neighbors.sweep_and_prune import near_pairs

DEEP = 0.01
"""Overlap of two bodies over the smaller one's size that is told."""
POINTS = 2000
"""That look from the surface of one for the inside of the other."""


def overlaps(obstacles: Obstacles) -> list[tuple[str, str, float]]:
    """Names of solids, one of which obeys forces, that are placed inside each other by more than DEEP of the smaller
    one's size, and how deep [m]."""
    return [
        (one, other, depth)
        for one, other, depth, size in _meetings(obstacles, obstacles.dynamic)
        if depth > DEEP * size
    ]


def _meetings(obstacles: Obstacles, dynamic: dict[int, Obstacle]) -> Iterator[tuple[str, str, float, float]]:
    hollow = [item for item in obstacles.placed if item.hollow]
    for item in dynamic.values():
        for wall in obstacles.walls:
            lowest = float((item.solid.surface.vertices @ wall.normal).min())
            yield item.name, wall.body, wall.offset - lowest, item.size
        for other in hollow:
            yield item.name, other.name, _depth_in_wall(item, other), min(item.size, other.size)
    for one, other in _near(obstacles.placed, dynamic):
        yield one.name, other.name, _depth(one, other), min(one.size, other.size)


def _near(placed: Sequence[Obstacle], dynamic: Container[int]) -> Iterator[tuple[Obstacle, Obstacle]]:
    """Pairs of solids whose boxes meet, the first of which obeys forces."""
    full = [place for place, item in enumerate(placed) if not item.hollow]
    bounds = np.array([placed[place].solid.bounds for place in full]).reshape(-1, 2, 3)
    free = np.array([place in dynamic for place in full], dtype=bool)
    for pair in near_pairs(bounds[:, 0], bounds[:, 1], free):
        one, other = (full[index] for index in pair)
        yield (placed[one], placed[other]) if one in dynamic else (placed[other], placed[one])


def _depth_in_wall(one: Obstacle, hollow: Obstacle) -> float:
    """How deep a surface comes into the wall of a container [m], 0 where it is within."""
    points = _surface(one, np.array([np.full(3, -np.inf), np.full(3, np.inf)]))
    return max(float(hollow.solid.signed_distance(points).max()), 0.0)


def _depth(one: Obstacle, other: Obstacle) -> float:
    """How deep the surface of one of them comes into the other [m], 0 where they are apart."""
    low, high = (np.array([item.solid.bounds[side] for item in (one, other)]) for side in (0, 1))
    common = np.array([low.max(axis=0), high.min(axis=0)])
    if np.any(common[0] >= common[1]):
        return 0.0
    looks = [(_surface(a, common), b) for a, b in ((one, other), (other, one))]
    return max(-min((float(b.solid.signed_distance(points).min(initial=0.0))) for points, b in looks), 0.0)


def _surface(item: Obstacle, within: np.ndarray) -> np.ndarray:
    """Points of a surface [m], shape [n, 3], in a box: vertices, and points on the triangles that reach into it."""
    mesh = item.solid.surface
    corners = mesh.vertices[mesh.faces]
    near = np.all((corners.max(axis=1) >= within[0]) & (corners.min(axis=1) <= within[1]), axis=1)
    if not near.any():
        return np.zeros((0, 3))
    some = np.flatnonzero(near)[:: -(-int(near.sum()) // POINTS)]
    points = np.concatenate([corners[some].reshape(-1, 3), cover(corners[some], POINTS)[0]])
    return points[np.all((points >= within[0]) & (points <= within[1]), axis=1)]
