"""One pass over the particles that tells whether a step can be trusted, and how long the next may be."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.device.argument_packs import argpack
from sim.device.arrays import DoubleTable, IntArray, Particles, Vec4Array, real, vec3
from sim.device.compiler import ti
from sim.fluid.boundary.gaps import pressing_density
from sim.fluid.kernel import cubic_host, particle_mass
from sim.fluid.layout import DENSITY, DISTANCE, Q, Resolution, Walls
from sim.fluid.spec import Fluid
from sim.fluid.sums import BLOCKS, span

Moving: Any = argpack(position=Vec4Array, velocity=Vec4Array, acceleration=Vec4Array)

ROW = 21
"""Numbers of a block of particles that a measure is made of."""


@dataclass(frozen=True)
class Measure:
    """What one pass over the particles tells about the whole fluid; SI units, local coordinates."""

    v_max: float
    a_max: float
    pace: float
    """The greatest v / 2 + sqrt(v^2 / 4 + a s), at which a particle goes a way s in a step t: v t + a t^2 = s."""
    kinetic_energy: float
    momentum: np.ndarray
    position_sum: np.ndarray
    density_max: float
    crowding_max: float
    """As density_max, but of what solids add no more than a particle alone has of them at rest [kg/m^3]."""
    pressure_max: float
    """No more than makes water as fast as it can be in the scene: where nothing gives way, pressures grow at will."""
    height: float
    """Along gravity, of a block of fluid whose heights vary as those of all particles do that do not fall alone [m]."""
    compression_sum: float
    not_finite: int
    beyond_walls: int
    too_fast: int
    fallen: int
    """Particles that have left the scene for good."""


STILL = Measure(0.0, 0.0, 0.0, 0.0, np.zeros(3), np.zeros(3), 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0, 0, 0)
"""The measure of no particles at all."""


class Meter:
    """Measures the fluid of a specification under this gravity [m/s^2]."""

    def __init__(self, spec: Fluid, gravity: np.ndarray):
        h = spec.support_radius
        self._gravity, self._rest_density = vec3(*gravity), spec.rest_density
        self._fall = float(np.linalg.norm(gravity))
        self._mass = particle_mass(spec.spacing, h, spec.rest_density)
        self._alone = 1.0 - self._mass * float(cubic_host(np.zeros(1), h)[0]) / spec.rest_density
        """What solids add to a particle alone at rest, over the rest density."""
        self._partial = ti.ndarray(ti.f64, (BLOCKS, ROW))

    def measure(
        self,
        particles: Particles,
        near: ti.Ndarray,
        walls: Walls,
        fluid: Resolution,
        *,
        distance: float,
        speed_limit: float,
        level: float,
        depth: float,
    ) -> Measure:
        """Extremes, sums and error counts, in a fixed order of summation; near: how many neighbours each has. The other
        arguments are those of `sim.fluid.system.FluidSystem.measure`."""
        if not particles.count:
            return STILL
        _measure(
            particles.count,
            particles.bundle(Moving),
            near,
            walls,
            fluid,
            self._alone,
            self._gravity,
            distance,
            speed_limit,
            level,
            depth,
            self._partial,
        )
        table = self._partial.to_numpy()
        peak, total = table.max(axis=0), table.sum(axis=0)
        return Measure(
            v_max=float(np.sqrt(peak[0])),
            a_max=float(np.sqrt(peak[1])),
            pace=float(peak[2]),
            kinetic_energy=0.5 * self._mass * float(total[3]),
            momentum=self._mass * total[4:7],
            position_sum=total[7:10],
            density_max=float(peak[10]),
            compression_sum=float(total[11]),
            not_finite=int(total[12]),
            beyond_walls=int(total[13]),
            too_fast=int(total[14]),
            fallen=int(total[15]),
            crowding_max=float(peak[16]),
            pressure_max=self._rest_density * min(self._rest_density * float(peak[17]), 0.5 * speed_limit**2),
            height=_height(total[18:21], self._fall),
        )


def _height(sums: np.ndarray, gravity: float) -> float:
    """Of a block whose heights have the variance of particles, by how many these are and the sums of their potentials
    [m^2/s^2] and of the squares of these; zero without gravity [m/s^2]."""
    count, depth, squared = sums
    if not (count and gravity):
        return 0.0
    return math.sqrt(12.0 * max(squared / count - (depth / count) ** 2, 0.0)) / gravity


@ti.kernel
def _measure(
    count: ti.i32,
    p: Moving,
    near: IntArray,
    walls: Walls,
    fluid: Resolution,
    alone: real,
    gravity: vec3,
    distance: real,
    speed_limit: real,
    level: real,
    depth: real,
    partial: DoubleTable,
):
    for block in range(BLOCKS):
        deepest, rest_density = 0.5 * fluid.h, fluid.rest_density
        row = ti.Vector([0.0] * ROW, dt=ti.f64)
        within = span(block, BLOCKS, count)
        for i in range(within[0], within[1]):
            x, v, a = p.position[i], p.velocity[i], p.acceleration[i]
            v2, a2 = v.xyz.dot(v.xyz), a.xyz.dot(a.xyz)
            row[0] = ti.max(row[0], v2)
            row[1] = ti.max(row[1], a2)
            fallen = gravity.dot(x.xyz) + level
            if near[i] > 0 or walls.size[i] > 0 or fallen <= deepest * gravity.norm():
                row[2] = ti.max(row[2], 0.5 * ti.sqrt(v2) + ti.sqrt(0.25 * v2 + distance * ti.sqrt(a2)))
                row[18] += 1.0
                row[19] += ti.cast(fallen, ti.f64)
                row[20] += ti.cast(fallen, ti.f64) ** 2
            row[3] += v2
            for axis in ti.static(range(3)):
                row[4 + axis] += v[axis]
                row[7 + axis] += x[axis]
            density = pressing_density(v[DENSITY], rest_density, walls.excess[i])
            row[10] = ti.max(row[10], density)
            crowded = v[DENSITY] - ti.max(walls.share[i].w - alone, 0.0) * rest_density
            row[16] = ti.max(row[16], pressing_density(crowded, rest_density, walls.excess[i]))
            row[11] += ti.max(density / rest_density - 1.0, 0.0)
            row[17] = ti.max(row[17], x[Q])
            finite = (
                ti.abs(v2) < 1e30
                and ti.abs(a2) < 1e30
                and x.xyz.dot(x.xyz) < 1e30
                and v[DENSITY] < 1e30
                and ti.abs(x[Q]) < 1e30
            )
            if not finite:
                row[12] += 1.0
            for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
                if walls.face[e][DISTANCE] < -deepest:
                    row[13] += 1.0
            if v2 > speed_limit * speed_limit + 2.0 * ti.max(fallen, 0.0):
                row[14] += 1.0
            if fallen > depth:
                row[15] += 1.0
        for column in ti.static(range(ROW)):
            partial[block, column] = row[column]
