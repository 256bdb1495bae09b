"""The bodies and walls of a scene, as the rigid part takes them."""

from __future__ import annotations

import numpy as np

from sim.bodies.obstacles import Obstacles
from sim.rigid.body import Body
from sim.rigid.collision.shapes import contact_shape, plane_shape
from sim.spec import SimulationSpec


def assemble(spec: SimulationSpec, obstacles: Obstacles) -> list[Body]:
    """All solids in the order of `obstacles.placed`, then all walls; raises Refused for a mass that no body has."""
    found = []
    for item in obstacles.placed:
        surface = spec.containers.get(item.name) or spec.rigid.bodies[item.name]
        shape = contact_shape(item.solid, hollow=item.hollow)
        if item.hollow or surface.motion != "dynamic":
            found.append(Body(item.name, shape, *surface.friction_coefficients, surface.restitution))
            continue
        mass = item.solid.mass_properties(surface.density)
        found.append(
            Body(
                item.name,
                shape,
                *surface.friction_coefficients,
                surface.restitution,
                mass=mass if surface.mass is None else mass.scaled_to(surface.mass),
                velocity=np.array(surface.velocity),
                angular_velocity=np.array(surface.angular_velocity),
                force=np.array(surface.force),
                torque=np.array(surface.torque),
                pulls=surface.pulls,
            )
        )
    for wall in obstacles.walls:
        surface = spec.containers.get(wall.body) or spec.rigid.bodies[wall.body]
        found.append(
            Body(wall.body, plane_shape(wall.normal, wall.offset), *surface.friction_coefficients, surface.restitution)
        )
    return found
