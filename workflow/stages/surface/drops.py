"""Lone drops: a particle that no other is near is a ball of its own volume, or spray of several smaller ones.

Marching cubes are about as large as a drop, so that it would be angular, and smaller, larger or gone, as it happens to
lie between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from sim.bodies.wall import Wall
from workflow.stages.surface.mesh import Surface

if TYPE_CHECKING:
    from trimesh import Trimesh

APART = 3.0
"""Least distance of lone particles from all others, in particle radii, however short the kernel: their balls, of 1.3
radii, do not meet."""
SMALLER = 0.6
"""Of the volume of one drop of spray, the next has."""
LIFTED = 0.7
"""Of its radius, how far the middle of a drop is from a wall at least: one that is behind it would be gone."""
SPREAD = 0.6
"""How far drops are from their particle at most, in spacings, before their middle is brought to it."""


def alone(positions: np.ndarray, reach: float) -> np.ndarray:
    """Which of the particles at `positions` [m], shape [n, 3], have no other within `reach` [m]; shape [n]."""
    nearest, _ = KDTree(positions).query(positions, k=[2], distance_upper_bound=reach)
    return np.isinf(nearest[:, 0])


def spray(
    centers: np.ndarray,
    velocities: np.ndarray,
    numbers: np.ndarray,
    spacing: float,
    count: int,
    walls: Sequence[Wall] = (),
) -> tuple[Surface, np.ndarray, np.ndarray]:
    """Drops of particles at `centers` [m] with `velocities` [m/s], float32, shape [k, 3], of `spacing` [m]: `count` of
    each, around the particle, which is their centre of mass but for those that `walls` would hide. Sizes and places are
    always the same for the same of the `numbers`, shape [k]. And the drop of each vertex, and the volumes of the drops
    [m^3]."""
    share = SMALLER ** np.arange(count)
    share /= share.sum()
    way = _directions(numbers, count) * SPREAD * spacing
    way -= np.einsum("j,ijk->ik", share, way)[:, None]
    volumes = np.tile(share * spacing**3, len(centers))
    places, volumes = centers[:, None] + way, np.tile(share * spacing**3, (len(centers), 1))
    radius = np.cbrt(volumes / (4 / 3 * np.pi))
    for wall in walls:
        lifted = np.maximum(LIFTED * radius - wall.distance(places), 0.0)
        places = places + lifted[..., None] * np.array(wall.normal)
    # the largest of each is as round as a lone ball, the others, which are many, as round as few pixels show
    largest = balls(places[:, 0], velocities, volumes[:, 0], 1)
    others = balls(places[:, 1:].reshape(-1, 3), np.repeat(velocities, count - 1, axis=0), volumes[:, 1:].ravel(), 0)
    vertices = np.repeat(
        [len(_unit_ball(level).vertices) for level in (1, 0)], [len(centers), len(centers) * (count - 1)]
    )
    drop = np.repeat(np.arange(volumes.size), vertices)
    return largest + others, drop, np.concatenate([volumes[:, 0], volumes[:, 1:].ravel()])


def balls(centers: np.ndarray, velocities: np.ndarray, volumes: np.ndarray, level: int) -> Surface:
    """Balls of `volumes` [m^3], shape [k], around `centers` [m] with `velocities` [m/s], shape [k, 3]; `level` of 0 are
    20 triangles each, 1 are 80."""
    if not len(centers):
        return Surface.empty()
    ball = _unit_ball(level)
    outwards, triangles = np.asarray(ball.vertices), np.asarray(ball.faces)
    radius = np.cbrt(volumes / ball.volume)
    vertices = centers[:, None].astype(np.float64) + radius[:, None, None] * outwards
    corners = len(outwards) * np.arange(len(centers))[:, None, None] + triangles
    return Surface(
        vertices.reshape(-1, 3).astype(np.float32),
        np.tile(outwards, (len(centers), 1)).astype(np.float32),
        np.repeat(velocities, len(outwards), axis=0).astype(np.float32),
        corners.reshape(-1, 3).astype(np.int32),
    )


def _directions(numbers: np.ndarray, count: int) -> np.ndarray:
    """Points spread evenly over a ball of radius 1, the same for the same number; shape [k, count, 3]."""
    seed = numbers.astype(np.uint64)[:, None] * np.uint64(3 * count) + np.arange(3 * count, dtype=np.uint64)
    first, second, third = np.moveaxis(_random(seed).reshape(-1, count, 3), 2, 0)
    height, turn, radius = 2 * first - 1, 2 * np.pi * second, np.cbrt(third)
    flat = np.sqrt(1 - height**2)
    return radius[..., None] * np.stack([flat * np.cos(turn), height, flat * np.sin(turn)], axis=-1)


def _random(state: np.ndarray) -> np.ndarray:
    """Numbers from 0 to below 1 that look random, of whole numbers, uint64 (SplitMix64, Steele et al. 2014)."""
    with np.errstate(over="ignore"):
        mixed = (state + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        mixed ^= mixed >> np.uint64(31)
    return (mixed >> np.uint64(11)).astype(np.float64) / 2.0**53


@cache
def _unit_ball(level: int) -> Trimesh:
    """Of 20 triangles or, as many as small cubes make of a drop, 80."""
    from trimesh.creation import icosphere

    return icosphere(subdivisions=level)
