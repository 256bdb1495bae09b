"""The fluid of a scene: its particles from start to end, and the solver that moves them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.device.arrays import numpy_real
from sim.fluid import load_solver
from sim.fluid.boundary.boundary import Boundary
from sim.fluid.boundary.shapes import BoundarySolid, Shapes
from sim.fluid.forces.registry import force_arrays
from sim.fluid.forces.velocity_smoothing import smoothing_arrays, viscosity_is_implicit
from sim.fluid.measure import Measure
from sim.fluid.seeding.seed import Room, Seed, seed
from sim.fluid.seeding.sources import Source
from sim.fluid.spec import Fluid
from sim.fluid.system import FluidSystem

if TYPE_CHECKING:
    from sim.fluid.boundary.one_sided_samples import OneSidedSamples

COMPRESSION_SPEED = 10.0
"""Speed of sound over the greatest speed expected: 1 % compression (Monaghan 1994)."""


@dataclass
class FluidState:
    """The particles between steps: what a checkpoint keeps and an event hands on.

    position, velocity, acceleration: shape [n, 4], of which three columns are coordinates relative to the world's
    origin; tag: identity and index of the fluid body, shape [n, 2]; slack: in gaps [m], and
    eased: what solids add that does not press yet, shape [n].
    """

    position: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), numpy_real))
    velocity: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), numpy_real))
    acceleration: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), numpy_real))
    tag: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    slack: np.ndarray = field(default_factory=lambda: np.zeros(0, numpy_real))
    eased: np.ndarray = field(default_factory=lambda: np.zeros(0, numpy_real))

    @property
    def count(self) -> int:
        """Number of particles."""
        return len(self.position)

    def without_body(self, body: int) -> FluidState:
        """The particles of all other bodies."""
        keep = self.tag[:, 1] != body
        return FluidState(*(values[keep] for values in vars(self).values()))

    def joined(self, other: FluidState) -> FluidState:
        """With the particles of another behind its own."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return FluidState(*(np.concatenate(pair) for pair in pairs))


@dataclass(frozen=True)
class Surroundings:
    """What the fluid meets, in world coordinates [m]; sheets: makes samples of sheets that are listed within a radius
    [m]."""

    solids: Sequence[BoundarySolid]
    sheets: Callable[[float], OneSidedSamples] | None = None


def pour(
    state: FluidState, source: Source, body: int, first: int, fluid: Fluid, origin: np.ndarray, room: Room
) -> tuple[FluidState, Seed]:
    """`state` and the particles of one more body where nothing else is, and these.

    `first` is the identity of the first of them, the others count on.
    Raises Refused where none has a place, or where there are more than the scene allows.
    """
    present = state.position[:, :3].astype(np.float64) + origin
    found = seed(source.solid, source.points, fluid.spacing, room, present)
    count = len(found.points)
    if not count:
        raise Refused(
            f"no particle of '{source.name}' lies inside the containers and outside solids and other fluid",
            location=source.location,
            remedy="move it to where there is room, or make it larger",
        )
    if state.count + count > fluid.max_particles:
        raise Refused(
            f"the scene has more than fluid.max_particles = {fluid.max_particles:,} particles",
            location=("fluid", "max_particles"),
            remedy=f"use a particle_radius above {_radius_for(state.count + count, fluid):.3g} m, or raise the limit",
        )
    fresh = FluidState(
        position=np.column_stack((found.points - origin, np.zeros(count))).astype(numpy_real),
        velocity=np.column_stack((source.flow.at(found.points), np.full(count, fluid.rest_density))).astype(numpy_real),
        acceleration=np.zeros((count, 4), numpy_real),
        tag=np.column_stack((first + np.arange(count), np.full(count, body))).astype(np.int32),
        slack=np.zeros(count, numpy_real),
        eased=np.zeros(count, numpy_real),
    )
    return state.joined(fresh), found


def _radius_for(count: int, fluid: Fluid) -> float:
    """The particle radius [m] at which as much fluid needs no more particles than allowed."""
    return fluid.particle_radius * (count / fluid.max_particles) ** (1 / 3)


class FluidModel:
    """Particles, surroundings and solver, built for one number of particles.

    `drop` is the greatest height [m] the fluid can fall, `fastest` the greatest speed [m/s] at the start, or of a body
    at any time. Nothing else is under the height `floor` [m], and `depth` [m] further down a particle is out of the
    scene. `probed`: whether the pressures of the last step will be asked for.
    """

    def __init__(
        self,
        fluid: Fluid,
        gravity: np.ndarray,
        origin: np.ndarray,
        state: FluidState,
        surroundings: Surroundings,
        *,
        drop: float,
        fastest: float,
        floor: float,
        depth: float,
        probed: bool = False,
    ):
        h = fluid.support_radius
        solver = load_solver(fluid.method)
        reach = h * (1 + solver.SKIN)
        shapes = Shapes(surroundings.solids, origin, fluid.spacing, h, all_hold=solver.HOLDS_ALONG_ALL)
        boundary = Boundary(shapes, fluid.spacing, h, reach)
        if surroundings.sheets:
            boundary.attach(surroundings.sheets(reach))
        self.origin = origin
        self.gravity = gravity
        g = float(np.linalg.norm(gravity))
        self._depth = g * depth if math.isfinite(depth) else math.inf
        up = -gravity / g if g > 0 else np.zeros(3)
        self._level = g * (floor - float(up @ origin))
        self.fastest_signal = fastest_signal(fluid, gravity, drop, fastest)
        signal = self.fastest_signal if solver.WEAKLY_COMPRESSIBLE else self.fastest_signal / COMPRESSION_SPEED
        implicit = not surroundings.sheets and viscosity_is_implicit(fluid, gravity, signal)
        arrays = solver.ARRAYS + force_arrays(fluid) + smoothing_arrays(fluid, implicit)
        if boundary.has_bodies or probed:
            arrays += solver.SAMPLE_ARRAYS
        boundary.shapes.set_floor(gravity, self._level)
        self.system = FluidSystem(fluid, gravity, boundary, arrays, solver.SKIN, implicit)
        self.system.load(vars(state))
        self.solver = solver(self.system, self.fastest_signal)

    @property
    def count(self) -> int:
        """Number of particles now."""
        return self.system.count

    def state(self) -> FluidState:
        """The particles as they are now."""
        return FluidState(**self.system.particles.state())

    def measure(self, cfl: float) -> Measure:
        """Extremes, sums and error counts; `cfl` says what share of half the support radius particles may go in a
        step."""
        return self.system.measure(0.5 * cfl * self.system.h, self.fastest_signal, self._level, self._depth)

    def remove_fallen(self) -> int:
        """Take out the particles that were measured out of the scene, before others are sorted; how many those were."""
        if not self.system.measured.fallen:
            return 0
        position = self.system.particles.numpy("position")[:, :3].astype(np.float64)
        return self.system.particles.leave_out(position @ self.gravity + self._level > self._depth)

    def potential_energy(self, measure: Measure) -> float:
        """In gravity [J], zero at the world's origin."""
        position_sum = measure.position_sum + self.count * self.origin
        return -self.system.mass * float(self.gravity @ position_sum)


def fastest_signal(fluid: Fluid, gravity: np.ndarray, drop: float, fastest: float) -> float:
    """The numerical speed of sound [m/s] (Monaghan 1994, sec. 4), faster than which no particle can be.

    `auto` follows from what the scene can reach: by falling, and by the surface tension of the smallest drops.
    """
    given = load_solver(fluid.method).speed_of_sound_given(fluid)
    if given is not None:
        return given
    g = float(np.linalg.norm(gravity))
    pulled = 2 * max(fluid.surface_tension, fluid.adhesion) / (fluid.rest_density * fluid.spacing)
    reachable = math.sqrt(fastest**2 + 2 * g * max(drop, fluid.spacing) + pulled)
    return COMPRESSION_SPEED * max(reachable, SLOWEST * fluid.spacing)


SLOWEST = 10.0
"""Speeds under this many spacings a second are not worth resolving: bounds the step of a scene at rest."""
