"""What viewers see of a running simulation: places of particles, bodies and cloth at one time, and its course."""

from __future__ import annotations

import itertools
from collections import deque
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sim.fluid.measure import Measure
    from sim.run.world import World

COURSE = ("time", "kinetic", "potential", "elastic", "density_error")
"""Columns of a course: s, J, J, J, and the mean compression as a share of the rest density."""
CELL = 1.25
"""Edge, in particle spacings, of cubes of which inside water hardly any is empty."""
MOST_CELLS = 2e7
LONGEST_COURSE = 2000
"""Rows of a course; older ones are let go."""


@dataclass(frozen=True)
class Solid:
    """A surface whose points [m], shape [n, 3], and triangles stay the same, about its own origin."""

    points: np.ndarray
    triangles: np.ndarray
    container: bool = False


@dataclass(frozen=True)
class Pose:
    """Where a solid is: its origin [m], and a unit quaternion w, x, y, z."""

    position: np.ndarray
    quaternion: np.ndarray


@dataclass(frozen=True)
class Picture:
    """One time of a run; arrays are not changed later."""

    frame: int
    time: float
    points: np.ndarray
    """Particles [m], single precision, shape [n, 3]."""
    velocity: np.ndarray
    """Of particles [m/s], shape [n, 3]."""
    density: np.ndarray
    """Of particles, over rest density, shape [n]."""
    body: np.ndarray
    """Number of the fluid body or emitter that particles came from, shape [n]."""
    origin: np.ndarray
    """What to add to the places of particles [m], shape [3]."""
    spacing: float
    """Of particles [m]; 0 without any."""
    poses: dict[str, Pose]
    cloths: dict[str, np.ndarray]
    """Points of sheets [m], shape [n, 3]."""
    scenery: int
    """Changes where there are other solids or sheets than before."""

    @cached_property
    def seen(self) -> np.ndarray:
        """Indices of the particles that others do not hide on all sides."""
        return near_the_surface(self.points, CELL * self.spacing) if self.spacing else np.arange(0)


@dataclass
class Scenery:
    """What of a picture stays the same from one to the next."""

    number: int = 0
    solids: dict[str, Solid] = field(default_factory=dict)
    cloths: dict[str, np.ndarray] = field(default_factory=dict)
    """Triangles of sheets."""
    edges: np.ndarray = field(default_factory=lambda: np.zeros((0, 2, 3)))
    """Of box containers: both ends [m], shape [n, 2, 3]."""


def picture(world: World, frame: int, time: float, scenery: int) -> Picture:
    """The world as it is."""
    points, velocity, spacing, density = np.zeros((0, 3), np.float32), np.zeros((0, 4), np.float32), 0.0, 1.0
    body = np.zeros(0, np.int32)
    settings = world.spec.fluid
    if world.fluid is not None and settings is not None:
        particles = world.fluid.system.particles
        points = particles.numpy("position")[:, :3].astype(np.float32, copy=False)
        velocity, body = particles.numpy("velocity"), particles.numpy("tag")[:, 1]
        spacing, density = settings.spacing, settings.rest_density
    return Picture(
        frame=frame,
        time=time,
        points=points,
        velocity=velocity[:, :3],
        density=velocity[:, 3] / np.float32(density),
        body=body,
        origin=np.array(world.origin),
        spacing=spacing,
        poses={item.name: _pose(item, time) for item in world.obstacles.placed if not item.hollow},
        cloths={item.name: world.cloth.vertices(item.name)[0] for item in world.sheets} if world.cloth else {},
        scenery=scenery,
    )


def scenery(world: World, number: int) -> Scenery:
    """What of the world's pictures stays the same."""
    solids = {}
    for item in world.obstacles.placed:
        centre = np.zeros(3) if item.hollow else item.centre
        mesh = item.solid.mesh
        if mesh is not None:
            solids[item.name] = Solid(mesh.vertices - centre, mesh.faces, item.hollow)
    cloths = {item.name: np.asarray(item.fabric.triangles) for item in world.sheets}
    edges = [_edges(bounds) for bounds in world.obstacles.box_bounds()]
    return Scenery(number, solids, cloths, np.concatenate(edges) if edges else np.zeros((0, 2, 3)))


def _edges(bounds: np.ndarray) -> np.ndarray:
    """Of a box [m], shape [2, 3]: ends of its edges, shape [12, 2, 3]."""
    corners = np.array(list(itertools.product((0, 1), repeat=3)))
    pairs = [(a, b) for a, b in itertools.combinations(corners, 2) if np.abs(a - b).sum() == 1]
    return np.where(np.array(pairs) == 0, bounds[0], bounds[1])


def _pose(item, time: float) -> Pose:
    movement = item.movement(time)
    turned = np.array([1.0, 0.0, 0.0, 0.0]) if movement is None else movement.quaternion()
    return Pose(item.centre_at(time), turned)


def near_the_surface(points: np.ndarray, cell: float) -> np.ndarray:
    """Indices of the points, shape [n, 3], beside whose cubes of this edge [m] there is an empty one; of all points,
    where they are spread too far for a grid."""
    columns = np.ascontiguousarray(points.T)
    lowest, highest = columns.min(axis=1, initial=np.inf), columns.max(axis=1, initial=-np.inf)
    if not len(points) or np.prod((highest - lowest) / cell + 3) > MOST_CELLS:
        return np.arange(len(points))
    shape = ((highest - lowest) / cell).astype(np.int64) + 3
    strides = (int(shape[1] * shape[2]), int(shape[2]), 1)
    index = np.full(len(points), sum(strides), np.int32)
    for column, low, stride in zip(columns, lowest, strides, strict=True):
        index += np.int32(stride) * ((column - low) / np.float32(cell)).astype(np.int32)
    full = np.zeros(shape.prod(), bool)
    full[index] = True
    hidden = full.copy()
    for stride in strides:
        hidden[stride:-stride] &= full[2 * stride :] & full[: -2 * stride]
    return np.flatnonzero(~hidden[index])


class Course:
    """Energies and errors over time; what a step adds counts once its frame is done."""

    def __init__(self):
        self._rows: deque[tuple[float, ...]] = deque(maxlen=LONGEST_COURSE)
        self._pending: list[tuple[float, ...]] = []

    def add(self, time: float, world: World, measure: Measure | None) -> None:
        """Note energies and compression of the world after a step, at `time` [s]; `measure` is what the fluid's solver
        found."""
        kinetic = potential = elastic = error = 0.0
        if measure is not None and world.fluid is not None and world.fluid.count:
            kinetic += measure.kinetic_energy
            potential += world.fluid.potential_energy(measure)
            error = measure.compression_sum / world.fluid.count
        for part in (world.rigid, world.cloth):
            if part:
                found = part.measure()
                kinetic += found.kinetic_energy
                potential += found.potential_energy
        if world.cloth:
            elastic = world.cloth.measure().elastic_energy
        self._pending.append((time, kinetic, potential, elastic, error))

    def settle(self) -> None:
        """Let what was added count: its frame is done."""
        self._rows.extend(self._pending)
        self._pending.clear()

    def drop(self) -> None:
        """Forget what was added since the last frame: its steps are to be repeated."""
        self._pending.clear()

    def back_to(self, time: float) -> None:
        """Forget what is later than `time` [s], and what no frame has settled."""
        self._pending.clear()
        self._rows = deque((row for row in self._rows if row[0] <= time), maxlen=LONGEST_COURSE)

    def columns(self) -> dict[str, np.ndarray]:
        """The rows that count, by the names in COURSE, each of shape [n]."""
        rows = np.array([*self._rows]).reshape(-1, len(COURSE))
        return {name: rows[:, column] for column, name in enumerate(COURSE)}
