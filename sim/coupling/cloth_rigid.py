"""Solids as cloth meets them, and what it does to those that obey forces.

In a step bodies move first, and the cloth has to follow; then they get the impulses of their contacts with it. So
momentum goes from one to the other exactly, but in turns, which is stable while a body is heavier than what it meets.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.cloth.collision import Wall
from sim.cloth.solids import Solids
from sim.obstacles import Obstacles
from sim.rigid.spec import Contact
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.cloth.part import ClothPart
    from sim.rigid.part import RigidPart


def find_solids(spec: SimulationSpec, obstacles: Obstacles, time: float) -> Solids:
    """Surfaces of all bodies and containers where they are at `time` [s], and all walls."""
    start, triangles, slide, hold = 0, [np.zeros((0, 3), int)], [np.zeros(0)], [np.zeros(0)]
    body = [np.zeros(0, int)]
    for index, item in enumerate(obstacles.placed):
        mesh = item.solid.mesh
        triangles.append(mesh.faces + start)
        start += len(mesh.vertices)
        grip = _surface(spec, item.name).grip
        slide.append(np.full(len(mesh.vertices), grip[0]))
        hold.append(np.full(len(mesh.vertices), grip[1]))
        body.append(np.full(len(mesh.vertices), index))
    walls = [Wall(wall.normal, wall.offset, *_surface(spec, wall.body).grip) for wall in obstacles.walls]
    parts = (np.concatenate(part) for part in (triangles, slide, hold, body))
    names, wall_names = [item.name for item in obstacles.placed], [wall.body for wall in obstacles.walls]
    filled = [index for index, item in enumerate(obstacles.placed) if item.solid.closed and not item.hollow]
    return Solids(places(obstacles, time), *parts, walls, names, wall_names, filled)


def places(obstacles: Obstacles, time: float) -> np.ndarray:
    """Where all points of the solids' surfaces are at `time` [s], in metres, shape [n, 3]."""
    found = [np.zeros((0, 3))]
    for item in obstacles.placed:
        movement = item.movement(time)
        found.append(item.solid.mesh.vertices if movement is None else movement.carry(item.solid.mesh.vertices))
    return np.concatenate(found)


def push(cloth: ClothPart, rigid: RigidPart, dt: float) -> None:
    """Give bodies what the cloth took from them in a step of dt [s]: the opposite impulses, at the same places."""
    points, force = cloth.collisions.on_solids()
    if not len(points):
        return
    body = cloth.solids.body[points - cloth.mesh.count]
    place = cloth.mesh.place.to_numpy()[points]
    impulse, turning = np.zeros((2, rigid.count, 3))
    np.add.at(impulse, body, dt * force)
    np.add.at(turning, body, dt * np.cross(place - rigid.position[body], force))
    rigid.kick(impulse, turning)


def _surface(spec: SimulationSpec, name: str) -> Contact:
    return spec.containers[name] if name in spec.containers else spec.rigid.bodies[name]
