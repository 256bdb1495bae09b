"""Particles on their way through the nozzles of emitters, and whether an outlet is free.

A particle that is led through nozzle e has the body number LED - e, and a velocity that no force changes. Beyond
the nozzle it gets the body number FREE. It passes the end of the nozzle within a step, and has fallen since then.
"""

import numpy as np
import taichi as ti

from sim.arrays import IntArray, IntTable, Vec2iArray, Vec4Array, numpy_real, real, vec3, vec4
from sim.fluid.emitters import Outlet
from sim.fluid.system import FluidSystem

FREE = -1
"""Body number of particles that came from an emitter."""
LED = -2
"""Body number of particles in the nozzle of emitter 0."""

ROOM = 0.9
"""A stream begins only where nothing is nearer than this many spacings: the holes of a full lattice are 0.87 wide."""
RUNNING_ROOM = 0.7
"""What a running stream meets is pushed away by what is led before it; nearer than this nothing may be."""
NEAR, NEARER = 1, 2
"""Marks of points of a layer that are nearer to other particles than ROOM, and than RUNNING_ROOM."""
TIGHT = 1.05
"""Over so many rest densities the fluid before an outlet has no room for more."""


class Streams:
    """The nozzles by number, as the device sees them; origin: of the world [m]."""

    def __init__(self, outlets: dict[int, Outlet], origin: np.ndarray):
        self.outlets = outlets
        self.origin = origin
        size = max(outlets, default=0) + 1
        mouth, stream = np.zeros((size, 4)), np.zeros((size, 4))
        for number, outlet in outlets.items():
            mouth[number] = [*(outlet.centre - origin), outlet.nozzle]
            stream[number] = [*outlet.velocity, outlet.speed]
        self._mouth, self._stream = ti.ndarray(vec4, size), ti.ndarray(vec4, size)
        self._mouth.from_numpy(mouth.astype(numpy_real))
        self._stream.from_numpy(stream.astype(numpy_real))
        self._slots, self._marks = {}, {}
        for number, outlet in outlets.items():
            slots = np.full(outlet.grid, -1, np.int32)
            slots[tuple(outlet.cells.T)] = np.arange(len(outlet.cells))
            self._slots[number] = ti.ndarray(ti.i32, outlet.grid)
            self._slots[number].from_numpy(slots)
            self._marks[number] = ti.ndarray(ti.i32, len(outlet.cells))

    def lead(self, system: FluidSystem) -> None:
        """Give the particles in the nozzles their velocity, and let go of those that are through."""
        particles = system.particles
        _lead(
            system.count,
            vec3(*system.gravity),
            self._mouth,
            self._stream,
            particles.position,
            particles.velocity,
            particles.acceleration,
            particles.tag,
        )

    def let_go(self, system: FluidSystem, number: int) -> None:
        """Free all particles in a nozzle."""
        _let_go(system.count, LED - number, system.particles.tag)

    def obstructed(self, system: FluidSystem, number: int, distance: float) -> tuple[np.ndarray, bool]:
        """Which particles of a layer that has come `distance` [m] further would be too near to other fluid, shape [n],
        and whether the fluid there is compressed."""
        outlet, particles, marks = self.outlets[number], system.particles, self._marks[number]
        near, led, tight = _examine(
            system.count,
            LED - number,
            vec3(*(outlet.centre + (outlet.spacing / 2 + distance) * outlet.direction - self.origin)),
            *(vec3(*axis) for axis in outlet.axes),
            outlet.spacing,
            system.h,
            TIGHT * system.spec.rest_density,
            particles.position,
            particles.velocity,
            particles.tag,
            self._slots[number],
            marks,
        )
        return marks.to_numpy() >= (NEARER if led else NEAR), 2 * tight > near


@ti.kernel
def _lead(
    count: ti.i32,
    gravity: vec3,
    mouth: Vec4Array,
    stream: Vec4Array,
    position: Vec4Array,
    velocity: Vec4Array,
    acceleration: Vec4Array,
    tag: Vec2iArray,
):
    for i in range(count):
        if tag[i].y <= LED:
            number = LED - tag[i].y
            v, speed = stream[number].xyz, stream[number].w
            beyond = (position[i].xyz - mouth[number].xyz).dot(v) / speed - mouth[number].w
            if beyond < 0:
                velocity[i].xyz = v
                acceleration[i].xyz = vec3(0.0)
            else:
                since = beyond / speed
                position[i].xyz += 0.5 * since * since * gravity
                velocity[i].xyz = v + since * gravity
                tag[i].y = FREE


@ti.kernel
def _let_go(count: ti.i32, body: ti.i32, tag: Vec2iArray):
    for i in range(count):
        if tag[i].y == body:
            tag[i].y = FREE


@ti.kernel
def _examine(
    count: ti.i32,
    own: ti.i32,
    middle: vec3,
    across: vec3,
    forward: vec3,
    along: vec3,
    spacing: real,
    h: real,
    tight_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    tag: Vec2iArray,
    slots: IntTable,
    marks: IntArray,
) -> ti.types.vector(3, ti.i32):
    """Particles within h of a layer's box, the layer's own ones before it, and those of the first that are compressed;
    what is near the points of the layer goes to `marks`."""
    for p in range(marks.shape[0]):
        marks[p] = 0
    rows, columns = slots.shape[0], slots.shape[1]
    reach = h / spacing
    near, led, tight = 0, 0, 0
    for i in range(count):
        d = (position[i].xyz - middle) / spacing
        row, column = d.dot(across) + 0.5 * (rows - 1), d.dot(along) + 0.5 * (columns - 1)
        ahead = d.dot(forward)
        inside = row > -reach and row < rows - 1 + reach and column > -reach and column < columns - 1 + reach
        if inside and ti.abs(ahead) < reach:
            near += 1
            if velocity[i].w > tight_density:
                tight += 1
            if tag[i].y == own:
                led += 1
            else:
                for k, m in ti.static(ti.ndrange((-1, 2), (-1, 2))):
                    r, c = ti.round(row, ti.i32) + k, ti.round(column, ti.i32) + m
                    if r >= 0 and r < rows and c >= 0 and c < columns:
                        gap = vec3(row - r, column - c, ahead).norm()
                        if slots[r, c] >= 0 and gap < ROOM:
                            ti.atomic_max(marks[slots[r, c]], ti.select(gap < RUNNING_ROOM, NEARER, NEAR))
    return ti.Vector([near, led, tight])
