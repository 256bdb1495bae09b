"""Fluid that touches plane walls: it goes on behind them while its surface is looked for, and ends flush with them.

Surfaces of particles are round where walls meet, and smoothing makes them rounder, so that a tank would not be full at
its edges. What is behind a wall can be as round as it likes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import KDTree

from sim.bodies.wall import Wall
from workflow.stages.surface.layers import NEXT, Cloud
from workflow.stages.surface.mesh import Surface

TOUCHING = 1.0
"""Particles nearer than this to a wall touch it, in spacings: a layer at rest is half a spacing away."""
TOGETHER = 6
"""Particles with fewer next to them are spray and stay as they are: 6 are next to the corner of a lattice. A lone drop
that went on behind its wall would be a string of beads, whose bulges fold over one another when they are pressed flat.
"""
BEHIND = 3
"""Layers that go on behind a wall: the smoothing of the surface reaches about as far."""


def continued(cloud: Cloud, spacing: float, walls: Sequence[Wall]) -> Cloud:
    """The same particles, of `spacing` [m], followed by copies of those that touch walls, in lines straight into them,
    with velocities along them."""
    positions, velocities = (part.astype(np.float64) for part in cloud)
    for wall in walls:
        normal = np.array(wall.normal)
        distance = wall.distance(positions)
        touching = np.flatnonzero(distance < TOUCHING * spacing)
        around = KDTree(positions[distance < (TOUCHING + NEXT) * spacing])
        next_to = around.query_ball_point(positions[touching], NEXT * spacing, return_length=True) - 1
        touching = touching[next_to >= TOGETHER]
        point, height = positions[touching], np.maximum(distance[touching], 0.0)
        along = velocities[touching] - (velocities[touching] @ normal)[:, None] * normal
        deep = [2 * height + layer * spacing for layer in range(BEHIND)]
        positions = np.concatenate([positions, *(point - way[:, None] * normal for way in deep)])
        velocities = np.concatenate([velocities, *[along] * BEHIND])
    return positions.astype(np.float32), velocities.astype(np.float32)


def flush(surface: Surface, walls: Sequence[Wall]) -> Surface:
    """The surface, of which what was behind walls has come to them: it looks into the wall, and moves along it."""
    place, outwards, velocity = (
        part.astype(np.float64) for part in (surface.vertices, surface.normals, surface.velocities)
    )
    for wall in walls:
        normal = np.array(wall.normal)
        place, behind = wall.pressed(place)
        outwards[behind] = -normal
        velocity[behind] -= (velocity[behind] @ normal)[:, None] * normal
    vertices, normals, velocities = (part.astype(np.float32) for part in (place, outwards, velocity))
    return Surface(vertices, normals, velocities, surface.triangles)
