"""Sums over points, springs and hinges, in a fixed order."""

from typing import Any

from sim.cloth.fabric.bending import fold, turned
from sim.cloth.fabric.layout import PARTITIONS, MassSpring
from sim.device.compiler import ti

vec5: Any = ti.types.vector(5, ti.f64)
Partitions: Any = ti.types.ndarray(dtype=vec5, ndim=1)


@ti.kernel
def measure(cloth: MassSpring, partitions: Partitions) -> vec5:
    """Kinetic energy, that in gravity, elastic energy [J], greatest speed [m/s], greatest stretch."""
    for partition in range(PARTITIONS):
        kinetic, high, elastic = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        fastest, stretch = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        count = cloth.point_count
        size = (count + PARTITIONS - 1) // PARTITIONS
        for i in range(ti.min(partition * size, count), ti.min((partition + 1) * size, count)):
            speed = cloth.velocity[i].norm()
            kinetic += 0.5 * cloth.mass[i] * speed * speed
            high -= cloth.mass[i] * cloth.gravity.dot(cloth.position[i])
            fastest = ti.max(fastest, speed)
        count = cloth.spring_count
        size = (count + PARTITIONS - 1) // PARTITIONS
        for k in range(ti.min(partition * size, count), ti.min((partition + 1) * size, count)):
            length = (cloth.position[cloth.spring_ends[2 * k]] - cloth.position[cloth.spring_ends[2 * k + 1]]).norm()
            over = length - cloth.rest_length[k]
            elastic += 0.5 * cloth.spring_stiffness[k] * over * over
            over_rest = ti.cast(1.0, ti.f64)
            if cloth.rest_length[k] > 0.0:
                over_rest = length / cloth.rest_length[k]
            stretch = ti.max(stretch, over_rest)
        count = cloth.hinge_count
        size = (count + PARTITIONS - 1) // PARTITIONS
        for k in range(ti.min(partition * size, count), ti.min((partition + 1) * size, count)):
            p, q = cloth.position[cloth.hinge_points[4 * k]], cloth.position[cloth.hinge_points[4 * k + 1]]
            r, s = cloth.position[cloth.hinge_points[4 * k + 2]], cloth.position[cloth.hinge_points[4 * k + 3]]
            over = turned(fold(p, q, r, s).angle, cloth.rest_angle[k])
            elastic += 0.5 * cloth.rigidity[k] * over * over
        partitions[partition] = vec5(kinetic, high, elastic, fastest, stretch)
    found = vec5(0.0, 0.0, 0.0, 0.0, 0.0)
    ti.loop_config(serialize=True)
    for partition in range(PARTITIONS):
        for column in ti.static(range(3)):
            found[column] += partitions[partition][column]
        for column in ti.static(range(3, 5)):
            found[column] = ti.max(found[column], partitions[partition][column])
    return found
