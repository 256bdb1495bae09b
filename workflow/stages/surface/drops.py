"""Lone drops: a particle that no other is near is a ball of its own volume.

Marching cubes are about as large as a drop, so that it would be angular, and smaller, larger or gone, as it happens to
lie between them.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from workflow.stages.surface.mesh import Surface

if TYPE_CHECKING:
    from trimesh import Trimesh

APART = 3.0
"""Least distance of lone particles from all others, in particle radii, however short the kernel: their balls, of 1.3
radii, do not meet."""


def alone(positions: np.ndarray, reach: float) -> np.ndarray:
    """Which of the particles at `positions` [m], shape [n, 3], have no other within `reach` [m]; shape [n]."""
    nearest, _ = KDTree(positions).query(positions, k=[2], distance_upper_bound=reach)
    return np.isinf(nearest[:, 0])


def balls(centers: np.ndarray, velocities: np.ndarray, volume: float) -> Surface:
    """Balls of a `volume` [m^3] each around `centers` [m] with `velocities` [m/s], float32, shape [k, 3]."""
    if not len(centers):
        return Surface.empty()
    ball = _unit_ball()
    outwards, triangles = np.asarray(ball.vertices), np.asarray(ball.faces)
    vertices = centers[:, None].astype(np.float64) + np.cbrt(volume / ball.volume) * outwards
    corners = len(outwards) * np.arange(len(centers))[:, None, None] + triangles
    return Surface(
        vertices.reshape(-1, 3).astype(np.float32),
        np.tile(outwards, (len(centers), 1)).astype(np.float32),
        np.repeat(velocities, len(outwards), axis=0),
        corners.reshape(-1, 3).astype(np.int32),
    )


@cache
def _unit_ball() -> Trimesh:
    """Of about as many triangles, 80, as small cubes make of a drop."""
    from trimesh.creation import icosphere

    return icosphere(subdivisions=1)
