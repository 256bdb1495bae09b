"""Bodies in a pool: what tests of the coupling of fluid and rigid bodies share."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tests.support.particles import positions, read_frame, read_table, velocities

RHO, G = 1000.0, 9.81
EDGE = 0.1
BOX = {"type": "box", "size": [EDGE, EDGE, EDGE]}


def pool(
    solver: str, spacing: float, size: tuple[float, float, float], depth: float, body: dict[str, Any], **more: Any
):
    """A tank of this size [m] filled to a depth [m], with one body in it."""
    water = {"shape": {"type": "box", "size": [size[0], depth, size[2]]}, "position": [0, depth / 2, 0]}
    fluid = {"solver": solver, "particle_radius": spacing / 2, "bodies": {"water": water}}
    return {
        "fps": 50,
        "containers": {"tank": {"type": "box", "size": list(size)}},
        "fluid": fluid | more.pop("fluid", {}),
        "rigid": {"bodies": {"body": body}},
    } | more


def box_in_pool(solver: str, ratio: float, height: float = 0.15, shape: dict | None = None, **more: Any):
    """A box so many times as dense as water, at a height [m] in a small pool 0.3 m deep."""
    body = {"shape": shape or BOX, "position": [0, height, 0], "density": ratio * RHO, "motion": "dynamic"}
    return pool(solver, 0.02, (0.4, 0.8, 0.4), 0.3, body, **more)


def track(out: Path, column: str, name: str = "body") -> np.ndarray:
    """A column of bodies.csv for one body, by frame."""
    table = read_table(out / "bodies.csv")
    return table[column][table["body"] == name]


def momentum(out: Path, frame: int, mass: float, inertia: float, particle_mass: float) -> tuple[np.ndarray, np.ndarray]:
    """Of fluid and one body, whose inertia is the same about all axes: linear [kg m/s] and angular [kg m^2/s]."""
    points = read_frame(out, frame)
    at, speed = positions(points), velocities(points)
    place, velocity, spin = (
        np.array([track(out, axis)[frame] for axis in axes])
        for axes in (("x", "y", "z"), ("vx", "vy", "vz"), ("wx", "wy", "wz"))
    )
    linear = particle_mass * speed.sum(axis=0) + mass * velocity
    angular = particle_mass * np.cross(at, speed).sum(axis=0) + mass * np.cross(place, velocity) + inertia * spin
    return linear, angular
