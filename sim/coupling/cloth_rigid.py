"""Solids as cloth meets them."""

from __future__ import annotations

import numpy as np

from sim.cloth.collision import Wall
from sim.cloth.solids import Solids
from sim.obstacles import Obstacles
from sim.rigid.spec import Contact
from sim.spec import SimulationSpec


def find_solids(spec: SimulationSpec, obstacles: Obstacles, time: float) -> Solids:
    """Surfaces of all bodies and containers where they are at `time` [s], and all walls."""
    start, triangles, slide, hold = 0, [np.zeros((0, 3), int)], [np.zeros(0)], [np.zeros(0)]
    for item in obstacles.placed:
        mesh = item.solid.mesh
        triangles.append(mesh.faces + start)
        start += len(mesh.vertices)
        grip = _grip(_surface(spec, item.name))
        slide.append(np.full(len(mesh.vertices), grip[0]))
        hold.append(np.full(len(mesh.vertices), grip[1]))
    walls = [Wall(wall.normal, wall.offset, *_grip(_surface(spec, wall.body))) for wall in obstacles.walls]
    parts = (np.concatenate(part) for part in (triangles, slide, hold))
    return Solids(places(obstacles, time), *parts, walls)


def places(obstacles: Obstacles, time: float) -> np.ndarray:
    """Where all points of the solids' surfaces are at `time` [s], in metres, shape [n, 3]."""
    found = [np.zeros((0, 3))]
    for item in obstacles.placed:
        movement = item.movement(time)
        found.append(item.solid.mesh.vertices if movement is None else movement.carry(item.solid.mesh.vertices))
    return np.concatenate(found)


def _surface(spec: SimulationSpec, name: str) -> Contact:
    return spec.containers[name] if name in spec.containers else spec.rigid.bodies[name]


def _grip(surface: Contact) -> tuple[float, float]:
    """Friction while sliding and at rest."""
    return surface.friction, surface.friction if surface.static_friction is None else surface.static_friction
