"""Sums over points, springs and hinges, in a fixed order."""

from typing import Any

import taichi as ti

from sim.cloth.fabric.bending import fold, turned
from sim.cloth.fabric.layout import ROWS, Angles, Points, Strands
from sim.device.double import vec3

vec5: Any = ti.types.vector(5, ti.f64)
Rows: Any = ti.types.ndarray(dtype=vec5, ndim=1)


@ti.kernel
def measure(
    points: ti.i32,
    springs: ti.i32,
    hinges: ti.i32,
    gravity: vec3,
    p: Points,
    s: Strands,
    a: Angles,
    rows: Rows,
) -> vec5:
    """Kinetic energy, that in gravity, elastic energy [J], greatest speed [m/s], greatest stretch."""
    for row in range(ROWS):
        kinetic, high, elastic = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        fastest, stretch = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        size = (points + ROWS - 1) // ROWS
        for i in range(ti.min(row * size, points), ti.min((row + 1) * size, points)):
            speed = p.velocity[i].norm()
            kinetic += 0.5 * p.mass[i] * speed * speed
            high -= p.mass[i] * gravity.dot(p.position[i])
            fastest = ti.max(fastest, speed)
        size = (springs + ROWS - 1) // ROWS
        for k in range(ti.min(row * size, springs), ti.min((row + 1) * size, springs)):
            length = (p.position[s.ends[2 * k]] - p.position[s.ends[2 * k + 1]]).norm()
            over = length - s.rest[k]
            elastic += 0.5 * s.stiff[k] * over * over
            over_rest = ti.cast(1.0, ti.f64)
            if s.rest[k] > 0.0:
                over_rest = length / s.rest[k]
            stretch = ti.max(stretch, over_rest)
        size = (hinges + ROWS - 1) // ROWS
        for k in range(ti.min(row * size, hinges), ti.min((row + 1) * size, hinges)):
            c = ti.Vector([a.corners[4 * k], a.corners[4 * k + 1], a.corners[4 * k + 2], a.corners[4 * k + 3]])
            hinge = fold(p.position[c[0]], p.position[c[1]], p.position[c[2]], p.position[c[3]])
            over = turned(hinge.angle, a.rest_angle[k])
            elastic += 0.5 * a.rigid[k] * over * over
        rows[row] = vec5(kinetic, high, elastic, fastest, stretch)
    found = vec5(0.0, 0.0, 0.0, 0.0, 0.0)
    ti.loop_config(serialize=True)
    for row in range(ROWS):
        for column in ti.static(range(3)):
            found[column] += rows[row][column]
        for column in ti.static(range(3, 5)):
            found[column] = ti.max(found[column], rows[row][column])
    return found
