"""Lone drops: a particle that no other is near is a ball of its own volume.

Marching cubes are about as large as a drop, so that it would be angular, and smaller, larger or gone, as it happens to
lie between them.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.spatial import KDTree

from workflow.surface_mesh import Surface

APART = 3.0
"""Least distance of lone particles from all others, in particle radii, however short the kernel: their balls, of 1.3
radii, do not meet."""


def alone(positions: np.ndarray, reach: float) -> np.ndarray:
    """Which of the particles at `positions` [m], shape [n, 3], have no other within `reach` [m]; shape [n]."""
    nearest, _ = KDTree(positions).query(positions, k=[2], distance_upper_bound=reach)
    return np.isinf(nearest[:, 0])


def balls(centers: np.ndarray, velocities: np.ndarray, volume: float) -> Surface:
    """Balls of a `volume` [m^3] each around `centers` [m] with `velocities` [m/s], float32, shape [k, 3]."""
    outwards, triangles = _unit_ball()
    of_one = np.linalg.det(outwards[triangles]).sum() / 6
    vertices = centers[:, None].astype(np.float64) + np.cbrt(volume / of_one) * outwards
    corners = len(outwards) * np.arange(len(centers))[:, None, None] + triangles
    return Surface(
        vertices.reshape(-1, 3).astype(np.float32),
        np.tile(outwards, (len(centers), 1)).astype(np.float32),
        np.repeat(velocities, len(outwards), axis=0),
        corners.reshape(-1, 3).astype(np.int32),
    )


@cache
def _unit_ball() -> tuple[np.ndarray, np.ndarray]:
    """Points of the unit sphere, shape [42, 3], and the triangles between them: about as many as small cubes make."""
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=1)
    return np.asarray(ball.vertices), np.asarray(ball.faces)
