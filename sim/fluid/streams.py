"""Particles on their way through the nozzles of emitters, and whether an outlet is free.

A particle that is led through nozzle e has the body number LED - e, and a velocity that no force changes. Beyond
the nozzle it gets the body number FREE. It passes the end of the nozzle within a step, and gravity acts from then on.
Where an emitter has been moved or removed, what is no longer in its nozzle is free as it is.
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
"""A stream is let go while fluid at its nozzle has over so many rest densities: led further, it would press into what
can not give way."""


class Streams:
    """The nozzles by number, as the device sees them; origin: of the world [m]."""

    def __init__(self, outlets: dict[int, Outlet], origin: np.ndarray):
        self.outlets = outlets
        self.origin = origin
        size = max(outlets, default=0) + 1
        self._pressed = ti.ndarray(ti.i32, size)
        tables = np.zeros((4, size, 4))
        for number, outlet in outlets.items():
            half = (np.array(outlet.grid) - 1) / 2 * outlet.spacing
            tables[:, number] = [
                [*(outlet.centre - origin), outlet.nozzle],
                [*outlet.velocity, outlet.speed],
                [*outlet.axes[0], half[0]],
                [*outlet.axes[2], half[1]],
            ]
        self._tables = [ti.ndarray(vec4, size) for _ in tables]
        """Centre, nozzle [m]; velocity, speed [m/s]; both directions across, and how far particles are there [m]."""
        for array, values in zip(self._tables, tables, strict=True):
            array.from_numpy(values.astype(numpy_real))
        self._slots, self._marks = {}, {}
        for number, outlet in outlets.items():
            slots = np.full(outlet.grid, -1, np.int32)
            slots[tuple(outlet.cells.T)] = np.arange(len(outlet.cells))
            self._slots[number] = ti.ndarray(ti.i32, outlet.grid)
            self._slots[number].from_numpy(slots)
            self._marks[number] = ti.ndarray(ti.i32, len(outlet.cells))

    def lead(self, system: FluidSystem) -> None:
        """Give the particles in the nozzles their velocity, and let go of those that are through, or pressed."""
        particles = system.particles
        _lead(
            system.count,
            vec3(*system.gravity),
            system.h,
            TIGHT * system.spec.rest_density,
            *self._tables,
            particles.position,
            particles.velocity,
            particles.acceleration,
            particles.tag,
            self._pressed,
        )

    def obstructed(self, system: FluidSystem, number: int, distance: float) -> np.ndarray:
        """Which particles of a layer that has come `distance` [m] further would be too near to others, shape [n]."""
        outlet, particles, marks = self.outlets[number], system.particles, self._marks[number]
        running = _examine(
            system.count,
            LED - number,
            vec3(*(outlet.centre + (outlet.spacing / 2 + distance) * outlet.direction - self.origin)),
            *(vec3(*axis) for axis in outlet.axes),
            outlet.spacing,
            particles.position,
            particles.tag,
            self._slots[number],
            marks,
        )
        return marks.to_numpy() >= (NEARER if running else NEAR)


@ti.kernel
def _lead(
    count: ti.i32,
    gravity: vec3,
    h: real,
    tight_density: real,
    mouth: Vec4Array,
    stream: Vec4Array,
    across: Vec4Array,
    along: Vec4Array,
    position: Vec4Array,
    velocity: Vec4Array,
    acceleration: Vec4Array,
    tag: Vec2iArray,
    pressed: IntArray,
):
    for number in range(pressed.shape[0]):
        pressed[number] = 0
    for i in range(count):
        if velocity[i].w > tight_density:
            for number in range(pressed.shape[0]):
                if near_nozzle(position[i].xyz, mouth[number], stream[number], across[number], along[number], h):
                    pressed[number] = 1
    for i in range(count):
        number = LED - tag[i].y
        if number >= 0:
            led = ti.cast(False, ti.u1)
            if number < pressed.shape[0] and pressed[number] == 0:
                led = near_nozzle(position[i].xyz, mouth[number], stream[number], across[number], along[number], h / 2)
            if led:
                v, speed = stream[number].xyz, stream[number].w
                beyond = (position[i].xyz - mouth[number].xyz).dot(v) / speed - mouth[number].w
                velocity[i].xyz = v
                if beyond < 0:
                    acceleration[i].xyz = vec3(0.0)
                else:
                    velocity[i].xyz += beyond / speed * gravity
                    tag[i].y = FREE
            else:
                tag[i].y = FREE


@ti.func
def near_nozzle(x: vec3, mouth: vec4, stream: vec4, across: vec4, along: vec4, margin: real) -> ti.u1:
    """Whether x lies in the box of a nozzle, or no further than `margin` beside it."""
    d = x - mouth.xyz
    ahead = d.dot(stream.xyz) / ti.max(stream.w, 1e-30)
    beside = ti.max(ti.abs(d.dot(across.xyz)) - across.w, ti.abs(d.dot(along.xyz)) - along.w)
    return stream.w > 0 and beside < margin and -margin < ahead and ahead < mouth.w + margin


@ti.kernel
def _examine(
    count: ti.i32,
    own: ti.i32,
    middle: vec3,
    across: vec3,
    forward: vec3,
    along: vec3,
    spacing: real,
    position: Vec4Array,
    tag: Vec2iArray,
    slots: IntTable,
    marks: IntArray,
) -> ti.i32:
    """Mark the points of a layer that others are near; returns how many of its own particles are led before it."""
    for p in range(marks.shape[0]):
        marks[p] = 0
    rows, columns = slots.shape[0], slots.shape[1]
    led = 0
    for i in range(count):
        d = (position[i].xyz - middle) / spacing
        row, column = d.dot(across) + 0.5 * (rows - 1), d.dot(along) + 0.5 * (columns - 1)
        ahead = d.dot(forward)
        if tag[i].y == own:
            led += 1
        elif ti.abs(ahead) < 1 and row > -1 and row < rows and column > -1 and column < columns:
            for k, m in ti.static(ti.ndrange((-1, 2), (-1, 2))):
                r, c = ti.round(row, ti.i32) + k, ti.round(column, ti.i32) + m
                if r >= 0 and r < rows and c >= 0 and c < columns:
                    gap = vec3(row - r, column - c, ahead).norm()
                    if slots[r, c] >= 0 and gap < ROOM:
                        ti.atomic_max(marks[slots[r, c]], ti.select(gap < RUNNING_ROOM, NEARER, NEAR))
    return led
