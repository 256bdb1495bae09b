"""The bodies and walls of a scene, as the rigid part takes them."""

from __future__ import annotations

import numpy as np

from sim.obstacles import Obstacles
from sim.rigid.body import Body
from sim.rigid.shapes import contact_shape, plane_shape
from sim.rigid.spec import Contact
from sim.spec import SimulationSpec


def assemble(spec: SimulationSpec, obstacles: Obstacles) -> list[Body]:
    """All solids in the order of `obstacles.placed`, then all walls; raises Refused for a mass that no body has."""
    found = []
    for item in obstacles.placed:
        surface = spec.containers.get(item.name) or spec.rigid.bodies[item.name]
        shape = contact_shape(item.solid, hollow=item.hollow)
        if item.hollow or surface.motion != "dynamic":
            found.append(Body(item.name, shape, *_grip(surface)))
            continue
        mass = item.solid.mass_properties(surface.density)
        found.append(
            Body(
                item.name,
                shape,
                *_grip(surface),
                mass=mass if surface.mass is None else mass.scaled_to(surface.mass),
                velocity=np.array(surface.velocity),
                angular_velocity=np.array(surface.angular_velocity),
                force=np.array(surface.force),
                torque=np.array(surface.torque),
            )
        )
    for wall in obstacles.walls:
        surface = spec.containers.get(wall.body) or spec.rigid.bodies[wall.body]
        found.append(Body(wall.body, plane_shape(wall.normal, wall.offset), *_grip(surface)))
    return found


def _grip(surface: Contact) -> tuple[float, float, float]:
    """Friction while sliding and at rest, and restitution."""
    rest = surface.friction if surface.static_friction is None else surface.static_friction
    return surface.friction, rest, surface.restitution
