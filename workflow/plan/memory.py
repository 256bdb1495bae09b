"""Estimates of the memory that the jobs need, for the scheduler [MB]."""

from __future__ import annotations

import math
from typing import Any

from scene.load import Scene
from sim.fluid.spec import Emitter

PROCESS = 1500
"""Python with Taichi, or Blender with the scene's lights and bodies."""
SIMULATED_PARTICLE = 1000
"""Arrays and neighbour lists of one particle [bytes]."""
MESHED_PARTICLE = 4000
"""Particle, density grid and triangles of one particle [bytes]."""
FOAMING_PARTICLE = 1500
"""Arrays and neighbour lists of one particle, of the fluid and of the foam that it makes [bytes]."""
RENDERED_PARTICLE = 2000
"""Triangles and acceleration structure of the surface, over the number of particles [bytes]."""
UNKNOWN_SIZE = 1.0
"""Of a mesh whose size the scene leaves to the file [m]."""


def estimate(stage: str, scene: Scene) -> int:
    """Memory of one job of a stage [MB]."""
    each = {
        "simulate": SIMULATED_PARTICLE,
        "reconstruct": MESHED_PARTICLE,
        "foam": FOAMING_PARTICLE,
        "render": RENDERED_PARTICLE,
    }
    return PROCESS + math.ceil(particles(scene) * each.get(stage, 0) / 1e6)


def particles(scene: Scene) -> int:
    """About how many fluid particles a scene has at the most."""
    fluid = scene.simulation.fluid
    if fluid is None:
        return 0
    return min(fluid.max_particles, math.ceil(fluid_volume(scene) / fluid.spacing**3))


def fluid_volume(scene: Scene) -> float:
    """Of all that is there at the start or flows in [m^3]; 0 without a fluid."""
    fluid = scene.simulation.fluid
    if fluid is None:
        return 0.0
    bodies = [*fluid.bodies.values()]
    for event in scene.simulation.events:
        bodies += event.add.fluid.values()
    volume = sum(_volume(body.shape) * body.scale**3 for body in bodies)
    emitters = [*fluid.emitters.values()]
    for event in scene.simulation.events:
        emitters += event.add.emitters.values()
    return volume + sum(_rate(emitter) * scene.duration for emitter in emitters)


def _rate(emitter: Emitter) -> float:
    """[m^3/s]"""
    if emitter.rate is not None:
        return emitter.rate
    match emitter.shape.type:
        case "disc":
            area = math.pi * emitter.shape.radius**2
        case "rectangle":
            area = math.prod(emitter.shape.size)
        case _:
            area = (emitter.shape.size or UNKNOWN_SIZE) ** 2
    return area * emitter.scale**2 * (emitter.speed or 0.0)


def _volume(shape: Any) -> float:
    """[m^3]; of a mesh, and of what a package adds, half the cube around it."""
    match shape.type:
        case "box":
            return math.prod(shape.size)
        case "sphere":
            return 4 / 3 * math.pi * shape.radius**3
        case "cylinder":
            return math.pi * shape.radius**2 * shape.height
        case "capsule":
            return math.pi * shape.radius**2 * (shape.height + 4 / 3 * shape.radius)
        case "torus":
            return 2 * math.pi**2 * shape.radius * shape.tube_radius**2
    return 0.5 * (getattr(shape, "size", None) or UNKNOWN_SIZE) ** 3
