"""The force of the fluid on one solid in the last step, as probes ask for it."""

from __future__ import annotations

import numpy as np

from sim.coupling.fluid_rigid.reaction import INERTIA, Reaction
from sim.fluid.forces.friction import find_wall_friction
from sim.fluid.pressure.gradient_correction import correct_pulls
from sim.fluid.system import FluidSystem

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""


def reaction(
    system: FluidSystem, solid: int, centre: np.ndarray, region: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Force [N] and torque about `centre` [N m] of the fluid on the solid with this index, in the last step.

    What it does to each particle is done to it at the nearest point of its surface, which has to be in the box
    `region`, shape [2, 3], if one is given; coordinates and `centre` are relative to the world's origin.
    """
    if not system.count or system.terms is None:
        return np.zeros(3), np.zeros(3)
    on_solid = Reaction(system, [solid])
    on_solid.list()
    if region is not None:
        _narrow(system, on_solid, region)
    inertia = np.zeros((1, INERTIA))
    inertia[0, :3] = centre
    on_solid.set_inertia(inertia)
    wrench = on_solid.forces(system.terms, find_wall_friction(system.spec).walls)[0] + on_solid.held()[0]
    position = system.particles.numpy("position").astype(np.float64)
    for pressure, displacement in _pushes(system, position):
        wrench = wrench + _pressed(system, solid, centre, position[:, :3] - displacement, pressure, region)
    return wrench[:3], wrench[3:]


def _narrow(system: FluidSystem, on_solid: Reaction, region: np.ndarray) -> None:
    """Leave only the pairs with a part of the surface that is in the region."""
    entry = on_solid.sums.order.to_numpy()[: on_solid.sums.ends.to_numpy()[-1]]
    faces = system.boundary.faces
    points = system.particles.numpy("position")[faces.particle.to_numpy()[entry], :3]
    kept = entry[_within(region, points, faces.face.to_numpy()[entry])]
    order = on_solid.sums.order.to_numpy()
    order[: len(kept)] = kept
    on_solid.sums.order.from_numpy(order)
    on_solid.sums.ends.from_numpy(np.array([0, len(kept)], dtype=np.int32))


def _within(region: np.ndarray, points: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Whether the nearest points of surfaces to `points` [m], shape [n, 3], are in a box; face: normal and distance,
    shape [n, 4]."""
    foot = points.astype(np.float64) - face[:, 3:] * face[:, :3]
    return np.all((foot >= region[0]) & (foot <= region[1]), axis=1)


def _pressed(
    system: FluidSystem,
    solid: int,
    centre: np.ndarray,
    points: np.ndarray,
    pressure: np.ndarray,
    region: np.ndarray | None,
) -> np.ndarray:
    """Wrench on a solid, shape [6], of pressures as q that acted where particles would have gone [m], shape [n, 3]."""
    faces = system.boundary.around(points)
    if hasattr(system.particles, "correction"):
        correct_pulls(system, faces)
    begin, size = faces.begin.to_numpy()[: len(points)], faces.size.to_numpy()[: len(points)]
    particle = np.repeat(np.arange(len(points)), size)
    entry = np.repeat(begin, size) + np.arange(len(particle)) - np.repeat(np.cumsum(size) - size, size)
    mine = faces.solid.to_numpy()[entry] == solid
    if region is not None:
        mine &= _within(region, points[particle], faces.face.to_numpy()[entry])
    particle, entry = particle[mine], entry[mine]
    pull = faces.pull.to_numpy()[entry, :3].astype(np.float64)
    force = system.mass * system.spec.rest_density * pressure[particle, None] * pull
    torque = np.cross(points[particle] - centre, force)
    return np.concatenate((force.sum(axis=0), torque.sum(axis=0)))


def _pushes(system: FluidSystem, position: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Pressures as q that were found for a step, and the way [m] of particles since they were looked for."""
    if not system.remembers:
        return []
    pressed = system.particles.numpy("pressed").astype(np.float64)
    if not hasattr(system.particles, "corrected"):
        return [(position[:, 3], pressed[:, :3])]
    corrected = system.particles.numpy("corrected").astype(np.float64)
    first = (position[:, 3] - corrected[:, 3], pressed[:, :3])
    return [first, (corrected[:, 3], corrected[:, :3])]
