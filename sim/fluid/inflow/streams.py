"""Particles on their way through the nozzles of emitters, and whether an outlet is free.

A particle that is led through nozzle e has the body number LED - e, and a velocity that no force changes. Beyond
the nozzle it gets the body number FREE. It passes the end of the nozzle within a step, and gravity acts from then on.
Where an emitter has been moved or removed, what is no longer in its nozzle is free as it is.
"""

import math
from typing import Any

import numpy as np

from sim.device.argument_packs import argpack
from sim.device.arrays import IntArray, IntTable, Vec2iArray, Vec4Array, numpy_real, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.inflow.emitters import Outlet
from sim.fluid.kernel import cubic
from sim.fluid.layout import DENSITY
from sim.fluid.system import FluidSystem

FREE = -1
"""Body number of particles that came from an emitter."""
LED = -2
"""Body number of particles in the nozzle of emitter 0."""

ROOM = 0.2
"""A particle is emitted where others, but those led before it, add at most this share of the rest density: a layer
0.9 spacings away does. With its own stream around it, it then has about 1.05 rest densities."""
SCALE = 1 << 16
"""Shares are summed as whole numbers of this part, so that their sum does not depend on threads."""
TIGHT = 1.05
"""A stream is let go while fluid at its nozzle has over so many rest densities: led further, it would press into what
cannot give way."""

Nozzles: Any = argpack(mouth=Vec4Array, stream=Vec4Array, across=Vec4Array, along=Vec4Array)
"""Centre of the outlet and length of the nozzle [m]; velocity and speed [m/s]; both directions across, and how far
particles are there [m]."""


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
        self._nozzles = Nozzles(*(ti.ndarray(vec4, size) for _ in tables))
        for (_, array), values in zip(self._nozzles.items, tables, strict=True):
            array.from_numpy(values.astype(numpy_real))
        self._slots, self._shares = {}, {}
        for number, outlet in outlets.items():
            slots = np.full(outlet.grid, -1, np.int32)
            slots[tuple(outlet.cells.T)] = np.arange(len(outlet.cells))
            self._slots[number] = ti.ndarray(ti.i32, outlet.grid)
            self._slots[number].from_numpy(slots)
            self._shares[number] = ti.ndarray(ti.i32, len(outlet.cells))

    def lead(self, system: FluidSystem) -> None:
        """Give the particles in the nozzles their velocity, and let go of those that are through, or pressed."""
        particles = system.particles
        _lead(
            system.count,
            vec3(*system.gravity),
            system.h,
            TIGHT * system.spec.rest_density,
            self._nozzles,
            particles.position,
            particles.velocity,
            particles.acceleration,
            particles.tag,
            self._pressed,
        )

    def crowded(self, system: FluidSystem, number: int, distance: float) -> np.ndarray:
        """Which particles of a layer that has come `distance` [m] further would have no room, shape [n]."""
        outlet, particles, shares = self.outlets[number], system.particles, self._shares[number]
        _crowd(
            system.count,
            LED - number,
            vec3(*(outlet.centre + (outlet.spacing / 2 + distance) * outlet.direction - self.origin)),
            *(vec3(*axis) for axis in outlet.axes),
            outlet.spacing,
            system.h,
            self._slots[number],
            particles.position,
            particles.tag,
            shares,
        )
        one = 8 / (math.pi * system.h**3) * system.mass / system.spec.rest_density
        return one * shares.to_numpy() > ROOM * SCALE


@ti.kernel
def _lead(
    count: ti.i32,
    gravity: vec3,
    h: real,
    tight_density: real,
    nozzles: Nozzles,
    position: Vec4Array,
    velocity: Vec4Array,
    acceleration: Vec4Array,
    tag: Vec2iArray,
    pressed: IntArray,
):
    for number in range(pressed.shape[0]):
        pressed[number] = 0
    for i in range(count):
        if velocity[i][DENSITY] > tight_density:
            for number in range(pressed.shape[0]):
                if near_nozzle(position[i].xyz, number, nozzles, h):
                    pressed[number] = 1
    for i in range(count):
        number = LED - tag[i].y
        if number >= 0:
            led = ti.cast(False, ti.u1)
            if number < pressed.shape[0] and pressed[number] == 0:
                led = near_nozzle(position[i].xyz, number, nozzles, h / 2)
            if led:
                v, speed = nozzles.stream[number].xyz, nozzles.stream[number].w
                mouth = nozzles.mouth[number]
                beyond = (position[i].xyz - mouth.xyz).dot(v) / speed - mouth.w
                velocity[i].xyz = v
                if beyond < 0:
                    acceleration[i].xyz = vec3(0.0)
                else:
                    velocity[i].xyz += beyond / speed * gravity
                    tag[i].y = FREE
            else:
                tag[i].y = FREE


@ti.func
def near_nozzle(x: vec3, number: ti.i32, nozzles: ti.template(), margin: real) -> ti.u1:
    """Whether x lies in the box of a nozzle, or no further than `margin` [m] beside it."""
    mouth, stream = nozzles.mouth[number], nozzles.stream[number]
    across, along = nozzles.across[number], nozzles.along[number]
    d = x - mouth.xyz
    ahead = d.dot(stream.xyz) / ti.max(stream.w, 1e-30)
    beside = ti.max(ti.abs(d.dot(across.xyz)) - across.w, ti.abs(d.dot(along.xyz)) - along.w)
    return stream.w > 0 and beside < margin and -margin < ahead and ahead < mouth.w + margin


@ti.kernel
def _crowd(
    count: ti.i32,
    own: ti.i32,
    middle: vec3,
    across: vec3,
    forward: vec3,
    along: vec3,
    spacing: real,
    h: real,
    slots: IntTable,
    position: Vec4Array,
    tag: Vec2iArray,
    shares: IntArray,
):
    """Sums of W h^3 pi / 8 over all but `own` particles, at the points of a layer, in parts of SCALE."""
    for p in range(shares.shape[0]):
        shares[p] = 0
    rows, columns = slots.shape[0], slots.shape[1]
    reach = ti.ceil(h / spacing, ti.i32)
    for i in range(count):
        d = (position[i].xyz - middle) / spacing
        row, column = d.dot(across) + 0.5 * (rows - 1), d.dot(along) + 0.5 * (columns - 1)
        ahead = d.dot(forward)
        inside = row > -reach and row < rows - 1 + reach and column > -reach and column < columns - 1 + reach
        if tag[i].y != own and inside and ti.abs(ahead) < reach:
            r0, c0 = ti.round(row, ti.i32), ti.round(column, ti.i32)
            for r in range(ti.max(r0 - reach, 0), ti.min(r0 + reach + 1, rows)):
                for c in range(ti.max(c0 - reach, 0), ti.min(c0 + reach + 1, columns)):
                    if slots[r, c] >= 0:
                        q = vec3(row - r, column - c, ahead).norm() * spacing / h
                        shares[slots[r, c]] += ti.round(cubic(q) * SCALE, ti.i32)
