"""Plane walls: the sides of box containers, and rigid bodies that are half-spaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.geometry.pose import rotation_matrix
from sim.geometry.spec import Placement, Plane
from sim.spec import SIDES, BoxContainer, SimulationSpec


@dataclass(frozen=True)
class PlaneWall:
    """The half-space n.x < offset; `body` names what it belongs to."""

    body: str
    normal: np.ndarray
    offset: float


def walls_of(spec: SimulationSpec) -> list[PlaneWall]:
    """Those that a scene begins with: of its bodies, then of its containers."""
    bodies = spec.rigid.bodies if spec.rigid else {}
    walls = [plane_of(name, body.shape, body) for name, body in bodies.items() if isinstance(body.shape, Plane)]
    for name, container in spec.containers.items():
        if isinstance(container, BoxContainer):
            walls += sides_of(name, container)
    return walls


def plane_of(name: str, shape: Plane, placement: Placement) -> PlaneWall:
    """The wall of a body that is a half-space."""
    normal = rotation_matrix(placement.rotation) @ np.array(shape.normal)
    normal /= np.linalg.norm(normal)
    return PlaneWall(name, normal, float(normal @ np.array(placement.position)))


def sides_of(name: str, container: BoxContainer) -> list[PlaneWall]:
    """The closed sides of a box container."""
    low, high = box_bounds(container)
    walls = []
    for index, side in enumerate(SIDES):
        if side in container.open:
            continue
        axis, upper = divmod(index, 2)
        normal = np.zeros(3)
        normal[axis] = -1.0 if upper else 1.0
        walls.append(PlaneWall(name, normal, float(normal[axis] * (high if upper else low)[axis])))
    return walls


def box_bounds(container: BoxContainer) -> np.ndarray:
    """Lower and upper corner of a box container [m], shape [2, 3]."""
    size, base = np.array(container.size), np.array(container.position)
    low = base - [size[0] / 2, 0.0, size[2] / 2]
    return np.array([low, low + size])
