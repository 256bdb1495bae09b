"""Foam from one frame to the next: birth, kinds, motion and age. Equations as in Ihmsen et al. 2012."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sim.bodies.wall import Wall
from sim.foam.fluid import Fluid, Passage
from sim.foam.spec import FoamJobSpec, FoamSpec, Range

if TYPE_CHECKING:
    from sim.foam.bodies import Passing, Placed

SPRAY, FOAM, BUBBLE = 0, 1, 2
RADIUS = 1 / 6
"""Of a mean particle of foam, over the fluid's particle radius."""

FOAM_POINT = np.dtype(
    [(name, "<f4") for name in ("x", "y", "z", "vx", "vy", "vz", "radius", "life")] + [("kind", "<i4")]
)
"""A particle of `foam_00042.ply`: world coordinates, SI units; `life` is what is left of it [s], `kind` 0 for spray, 1
for foam, 2 for a bubble. A frame holds all that the next follows from."""


def clamp(values: np.ndarray, bounds: Range) -> np.ndarray:
    """0 below `low`, 1 from `high` on, linear in between (eq. 1)."""
    return (np.clip(values, bounds.low, bounds.high) - bounds.low) / (bounds.high - bounds.low)


def rates(trapped: np.ndarray, crest: np.ndarray, velocity: np.ndarray, spec: FoamSpec) -> np.ndarray:
    """Particles of foam that each particle of the fluid makes [1/s] (eq. 9 and the one after); shape [n]."""
    energy = (velocity.astype(np.float64) ** 2).sum(axis=1)
    low, high = spec.agitation.low**2, spec.agitation.high**2
    moving = (np.clip(energy, low, high) - low) / (high - low)
    air = spec.trapped_air.rate * clamp(trapped, spec.trapped_air)
    return moving * (air + spec.wave_crest.rate * clamp(crest, spec.wave_crest))


def born(
    fluid: Fluid, spec: FoamJobSpec, step: float, dice: np.random.Generator, bodies: Sequence[Placed] = ()
) -> np.ndarray:
    """New FOAM_POINTs of one step [s]: in the cylinders that the fluid's particles sweep in it (eq. 10), outside
    of walls and bodies."""
    foam = spec.foam
    rate = rates(*fluid.potentials(), fluid.velocity, foam)
    number = np.floor(rate * step + dice.random(fluid.count)).astype(np.int64)
    parent = np.repeat(np.arange(fluid.count), number)
    points = np.zeros(len(parent), FOAM_POINT)
    velocity = fluid.velocity[parent]
    speed = np.linalg.norm(velocity, axis=1)
    along = velocity / np.maximum(speed, 1e-12)[:, None]
    first, second = _across(along)
    distance = spec.particle_radius * np.sqrt(dice.random(len(parent)))
    angle = 2 * math.pi * dice.random(len(parent))
    ahead = speed * step * dice.random(len(parent))
    offset = distance[:, None] * (np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second)
    position, velocity, _ = held(fluid.position[parent] + offset + ahead[:, None] * along, velocity, spec.walls, bodies)
    _put(points, "xyz", position)
    _put(points, ("vx", "vy", "vz"), velocity)
    most = max(foam.trapped_air.rate + foam.wave_crest.rate, 1e-12)
    life = foam.lifetime
    points["life"] = life.low + (life.high - life.low) * rate[parent] / most
    mean = foam.radius or RADIUS * spec.particle_radius
    points["radius"] = mean * (0.5 + dice.random(len(parent)))
    return points


def moved(
    points: np.ndarray, fluid: Fluid, spec: FoamJobSpec, step: float, bodies: Sequence[Placed] = ()
) -> np.ndarray:
    """The same points a step [s] later, without those whose life is over; fluid and bodies are those at its end.

    Spray flies (eq. 11), bubbles rise and are carried along (12), both integrated exactly; foam goes with the
    fluid (13).
    """
    foam = spec.foam
    gravity = np.array(spec.gravity)
    points = points.copy()
    position, velocity = _get(points, "xyz"), _get(points, ("vx", "vy", "vz"))
    carried, near = fluid.around(position)
    kind = np.where(near < foam.spray_below, SPRAY, np.where(near > foam.bubbles_above, BUBBLE, FOAM))
    flying, rising, floating = (kind[:, None] == one for one in (SPRAY, BUBBLE, FOAM))
    steady = carried - foam.buoyancy * foam.relaxation_time * gravity
    kept = math.exp(-step / foam.relaxation_time)
    later = np.where(flying, velocity + step * gravity, np.where(rising, steady + kept * (velocity - steady), carried))
    caught_up = step * steady + foam.relaxation_time * (1 - kept) * (velocity - steady)
    distance = np.where(flying, 0.5 * step * (velocity + later), np.where(rising, caught_up, step * carried))
    position, later, touching = held(position + distance, later, spec.walls, bodies)
    ages = floating[:, 0] | (flying[:, 0] & touching)
    points["kind"] = kind
    points["life"] -= np.where(ages, step, 0.0).astype(np.float32)
    _put(points, "xyz", position)
    _put(points, ("vx", "vy", "vz"), later)
    return points[points["life"] > 0]


def held(
    position: np.ndarray, velocity: np.ndarray, walls: Sequence[Wall], bodies: Sequence[Placed] = ()
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions and velocities, shape [n, 3], of what runs into walls and bodies and sticks to them, and whether it
    does, shape [n]. Where a body touches a wall, the wall has the last word."""
    touching = np.zeros(len(position), bool)
    for body in bodies:
        position, velocity, inside = body.held(position, velocity)
        touching |= inside
    for wall in walls:
        position, through = wall.pressed(position)
        velocity = np.where(through[:, None], 0.0, velocity)
        touching |= through
    return position, velocity, touching


def next_frame(
    points: np.ndarray,
    before: np.ndarray,
    after: np.ndarray,
    frame: int,
    spec: FoamJobSpec,
    bodies: Sequence[Passing] = (),
) -> tuple[np.ndarray, bool]:
    """The FOAM_POINTs of `frame` from those of the frame before, and whether there is no room for more.

    before, after: the records of the fluid in both frames.
    """
    duration = 1.0 / spec.fps
    steps = max(1, math.ceil(duration / spec.foam.max_step))
    passage, full = Passage(before, after, duration), False
    for k in range(steps):
        share, step = (k + 1) / steps, duration / steps
        fluid = Fluid(*passage.at(share), spec.support_radius, 2 * spec.particle_radius)
        placed = [body.at(share, duration) for body in bodies]
        points = moved(points, fluid, spec, step, placed)
        fresh = born(fluid, spec, step, np.random.default_rng([spec.foam.seed, frame, k]), placed)
        room = max(0, spec.foam.max_particles - len(points))
        full |= len(fresh) > room
        points = np.concatenate((points, fresh[:room]))
    return points, full


def _across(along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors at right angles to unit vectors and each other, shape [n, 3]."""
    least = np.abs(along).argmin(axis=1)
    first = np.cross(along, np.eye(3)[least])
    first /= np.maximum(np.linalg.norm(first, axis=1), 1e-12)[:, None]
    return first, np.cross(along, first)


def _get(points: np.ndarray, names: Sequence[str]) -> np.ndarray:
    return np.stack([points[name] for name in names], axis=1).astype(np.float64)


def _put(points: np.ndarray, names: Sequence[str], values: np.ndarray) -> None:
    for axis, name in enumerate(names):
        points[name] = values[:, axis]
