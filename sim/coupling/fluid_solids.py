"""What the fluid meets of solids: their shapes, how they move, and where it cannot start."""

from __future__ import annotations

import numpy as np

from sim.bodies.obstacles import Obstacle, Obstacles
from sim.fluid.boundary.shapes import MOTION, BoundarySolid, half_space
from sim.geometry.distance.narrow_band import NarrowBand, narrow_band
from sim.geometry.distance.sdf import GRID
from sim.geometry.primitives import Primitive, primitive
from sim.geometry.solids import Solid

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""

CELL = 0.5
"""Spacings between the nodes at which the distance to a mesh is known."""


def boundary_solids(obstacles: Obstacles, spacing: float, h: float) -> list[BoundarySolid]:
    """All solids: first the bodies and containers with a surface, in the order of `obstacles.placed`, then the
    planes."""
    bodies = [_boundary_solid(item, spacing, h) for item in obstacles.placed]
    return bodies + [half_space(wall.normal, wall.offset) for wall in obstacles.walls]


def _boundary_solid(item: Obstacle, spacing: float, h: float) -> BoundarySolid:
    shape = primitive(item.solid)
    band = _band(item.solid, shape, spacing, h) if shape.kind == GRID else None
    pivot = item.motion.pivot if item.motion else None
    thin = shape.kind == GRID or float(2 * shape.half.min()) < h
    free = bool(item.motion and item.motion.obeys_forces)
    return BoundarySolid(shape, band, pivot, item.hollow, thin, free, _thickness(shape, band))


def _thickness(shape: Primitive, band: NarrowBand | None) -> float:
    """Diameter [m] of the largest ball inside; of a mesh as far as its band reaches."""
    return 2.0 * float(shape.half.min() if band is None else max(0.0, -band.nodes[:, 3].min()))


def _band(solid: Solid, shape: Primitive, spacing: float, h: float) -> NarrowBand:
    import trimesh

    mesh = trimesh.Trimesh(solid.surface.vertices - shape.origin, solid.surface.faces, process=False)
    return narrow_band(mesh, CELL * spacing, h)


def motions(obstacles: Obstacles, origin: np.ndarray, time: float) -> np.ndarray:
    """How the bodies that move have moved by `time` [s], as `sim.fluid.boundary.shapes` wants it: shape [bodies,
    MOTION].

    Coordinates are relative to `origin` [m].
    """
    rows = [
        np.concatenate((now.rotation.ravel(), now.position - origin, now.velocity, now.angular_velocity))
        for now in (item.movement(time) for item in obstacles.placed)
        if now is not None
    ]
    return np.array(rows).reshape(-1, MOTION)


def allowed(obstacles: Obstacles, points: np.ndarray, clearance: float, time: float) -> np.ndarray:
    """Whether fluid can be at `points` [m], shape [n, 3], at `time` [s]: `clearance` off every solid; shape [n]."""
    free = np.ones(len(points), dtype=bool)
    for wall in obstacles.walls:
        free &= points @ wall.normal - wall.offset > clearance
    for item in obstacles.placed:
        placed, near = _placed(item, points, clearance, time)
        distance = np.full(len(points), np.inf)
        distance[near & free] = item.solid.signed_distance(placed[near & free])
        free &= (distance < -clearance) if item.hollow else (distance > clearance)
    return free


def _placed(item: Obstacle, points: np.ndarray, reach: float, time: float) -> tuple[np.ndarray, np.ndarray]:
    """The points [m] as the placed body sees them, shape [n, 3], and which are within `reach` [m] of its box."""
    movement = item.movement(time)
    placed = movement.carry_back(points) if movement else points
    low, high = item.solid.bounds
    return placed, np.all((placed > low - reach) & (placed < high + reach), axis=1)
