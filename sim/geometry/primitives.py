"""What a placed solid is in its own frame: a primitive with closed forms, or a mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.geometry.analytic_solids import BoxSolid, CapsuleSolid, CylinderSolid, SphereSolid, TorusSolid
from sim.geometry.distance.sdf import BOX, CAPSULE, CYLINDER, GRID, SPHERE, TORUS
from sim.geometry.solids import SheetSolid, Solid


@dataclass(frozen=True)
class Primitive:
    """kind: of `sim.geometry.distance.sdf`; size: of a box its half edges, else radius and half length, or both radii
    of a torus [m], shape [3]; origin [m] and turn of its own frame as it is placed; half: its half extents there
    [m]."""

    kind: int
    size: np.ndarray
    origin: np.ndarray
    turn: np.ndarray
    half: np.ndarray


def primitive(solid: Solid) -> Primitive:
    """A mesh is GRID, its frame that of the world about the middle of its box."""
    scale, turn, origin = solid.pose.scale, solid.pose.rotation, solid.pose.position
    match solid:
        case SphereSolid():
            kind, size = SPHERE, np.full(3, scale * solid.radius)
            half = size
        case BoxSolid():
            kind, size = BOX, scale * solid.size / 2
            half = size
        case SheetSolid():
            kind, size = BOX, scale * np.array([solid.size[0] / 2, 0.0, solid.size[1] / 2])
            half = size
        case CapsuleSolid():
            radius, length = scale * solid.radius, scale * solid.height / 2
            kind, size, half = CAPSULE, np.array([radius, length, 0]), np.array([radius, length + radius, radius])
        case CylinderSolid():
            radius, length = scale * solid.radius, scale * solid.height / 2
            kind, size, half = CYLINDER, np.array([radius, length, 0]), np.array([radius, length, radius])
        case TorusSolid():
            radius, tube = scale * solid.radius, scale * solid.tube_radius
            kind, size, half = TORUS, np.array([radius, tube, 0]), np.array([radius + tube, tube, radius + tube])
        case _:
            low, high = np.asarray(solid.bounds)
            kind, size, half = GRID, np.zeros(3), (high - low) / 2
            origin, turn = (low + high) / 2, np.eye(3)
    return Primitive(kind, size, origin, turn, half)
