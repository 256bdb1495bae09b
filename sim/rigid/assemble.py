"""The bodies and walls of a scene, as the rigid part takes them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim.bodies.obstacles import Obstacles
from sim.geometry.solids import Solid
from sim.rigid.body import Body
from sim.rigid.collision.shapes import contact_shape, plane_shape
from sim.rigid.spec import Contact, RigidBody
from sim.spec import SimulationSpec


def assemble(spec: SimulationSpec, obstacles: Obstacles) -> list[Body]:
    """All solids in the order of `obstacles.placed`, then all walls; raises Refused for a mass that no body has."""
    bodies = spec.rigid.bodies if spec.rigid else {}
    found = []
    for item in obstacles.placed:
        surface: Contact = spec.containers.get(item.name) or bodies[item.name]
        kinetic, static = surface.friction_coefficients
        shape = contact_shape(item.solid, hollow=item.hollow)
        body = Body(item.name, shape, kinetic, static, surface.restitution)
        if isinstance(surface, RigidBody) and surface.motion == "dynamic" and not item.hollow:
            body = _dynamic(body, item.solid, surface)
        found.append(body)
    for wall in obstacles.walls:
        surface = spec.containers.get(wall.body) or bodies[wall.body]
        kinetic, static = surface.friction_coefficients
        found.append(Body(wall.body, plane_shape(wall.normal, wall.offset), kinetic, static, surface.restitution))
    return found


def _dynamic(body: Body, solid: Solid, given: RigidBody) -> Body:
    """The same body, which obeys forces."""
    mass = solid.mass_properties(given.density)
    return replace(
        body,
        mass=mass if given.mass is None else mass.scaled_to(given.mass),
        velocity=np.array(given.velocity),
        angular_velocity=np.array(given.angular_velocity),
        force=np.array(given.force),
        torque=np.array(given.torque),
        pulls=given.pulls,
    )
