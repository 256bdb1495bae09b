"""Solids as cloth meets them, and what it does to those that obey forces.

In a step bodies move first, as if there were no cloth. Where they go then is not the last word: the equations of the
cloth have two more rows for each body, its way and its turn, so that both find where they are at the end of the step at
once, whichever is heavier (`sim.cloth.contact.dynamic_solids`), and contacts of these bodies with others are among
those of the cloth. So what rests on cloth rests, and contacts between the two make no energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scene.settings import given
from sim.bodies.obstacles import Obstacles
from sim.cloth.contact.dynamic_solids import Bodies, Meetings
from sim.cloth.contact.solids import Solids, Wall
from sim.rigid.spec import Contact
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.cloth.model import ClothModel
    from sim.rigid.model import RigidModel

MATERIALS = ("cloth",)
"""Of a scene, for this to be loaded."""


def find_solids(spec: SimulationSpec, obstacles: Obstacles, time: float) -> Solids:
    """Surfaces of all bodies and containers where they are at `time` [s], and all walls."""
    start, triangles, kinetic, static = 0, [np.zeros((0, 3), int)], [np.zeros(0)], [np.zeros(0)]
    body, made = [np.zeros(0, int)], [np.zeros((0, 3))]
    for index, item in enumerate(obstacles.placed):
        mesh = item.solid.surface
        made.append(mesh.vertices)
        triangles.append(mesh.faces + start)
        start += len(mesh.vertices)
        friction = _surface(spec, item.name).friction_coefficients
        kinetic.append(np.full(len(mesh.vertices), friction[0]))
        static.append(np.full(len(mesh.vertices), friction[1]))
        body.append(np.full(len(mesh.vertices), index))
    return Solids(
        points=places(obstacles, time),
        made=np.concatenate(made),
        triangles=np.concatenate(triangles),
        kinetic_friction=np.concatenate(kinetic),
        static_friction=np.concatenate(static),
        body=np.concatenate(body),
        walls=[
            Wall(wall.normal, wall.offset, *_surface(spec, wall.body).friction_coefficients) for wall in obstacles.walls
        ],
        names=[item.name for item in obstacles.placed],
        wall_names=[wall.body for wall in obstacles.walls],
        dynamic=list(obstacles.dynamic),
        filled=[index for index, item in enumerate(obstacles.placed) if item.solid.closed and not item.hollow],
    )


def places(obstacles: Obstacles, time: float) -> np.ndarray:
    """Where all points of the solids' surfaces are at `time` [s], in metres, shape [n, 3]."""
    found = [np.zeros((0, 3))]
    for item in obstacles.placed:
        movement = item.movement(time)
        found.append(item.solid.surface.vertices if movement is None else movement.carry(item.solid.surface.vertices))
    return np.concatenate(found)


def ahead(cloth: ClothModel, rigid: RigidModel, dt: float) -> Bodies:
    """Bodies where a step of dt [s] took them that the cloth has not changed yet."""
    dynamic = cloth.solids.dynamic
    inertia = np.linalg.inv(rigid.mobility(rigid.motions()[dynamic, :9].reshape(-1, 3, 3), np.array(dynamic, int)))
    return Bodies(
        rigid.position[dynamic],
        rigid.mass[dynamic],
        inertia,
        rigid.path_deviation[dynamic],
        _meetings(dynamic, rigid, dt),
    )


def _meetings(dynamic: list[int], rigid: RigidModel, dt: float) -> Meetings:
    """Where bodies touch one another and other solids."""
    met = rigid.meetings(dt)
    if met is None:
        return Meetings.none()
    pair, place, *others = met
    row = np.full(rigid.count, -1)
    row[dynamic] = np.arange(len(dynamic))
    return Meetings(row[pair], place[:, None] - rigid.position[pair], *others)


def push(cloth: ClothModel, rigid: RigidModel, dt: float) -> None:
    """Let bodies give way to the cloth as it found in a step of dt [s]."""
    collisions, bodies = cloth.collisions, cloth.collisions.bodies
    dynamic = np.array(cloth.solids.dynamic)
    rigid.apply_response(dynamic, dt * (collisions.on_bodies() - bodies.load), *bodies.displacements())
    rigid.rebound(dt, dynamic, dt * collisions.of_cloth(), bodies.taken, collisions.between_bodies())


def _surface(spec: SimulationSpec, name: str) -> Contact:
    return spec.containers[name] if name in spec.containers else given(spec.rigid).bodies[name]
