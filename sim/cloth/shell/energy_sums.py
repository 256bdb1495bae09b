"""Elastic energy and extremes of a shell, in a fixed order."""

from sim.cloth.fabric.energy_sums import Partitions, vec5
from sim.cloth.fabric.layout import PARTITIONS, Points
from sim.cloth.fabric.partition_sums import partition_start
from sim.cloth.shell.elements import barrier, bending_energy, bent, curvature, frame, strain, stress_of
from sim.cloth.shell.layout import ShellRest
from sim.device.compiler import ti


@ti.kernel
def measure(triangles: ti.i32, points: ti.i32, p: Points, shell: ShellRest, partitions: Partitions) -> vec5:
    """In the third place the elastic energy [J], and in the fifth the greatest stretch."""
    for partition in range(PARTITIONS):
        elastic, stretch = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        for t in range(partition_start(partition, triangles), partition_start(partition + 1, triangles)):
            f = frame(t, shell, p.position)
            e = strain(f)
            stored = 0.5 * stress_of(t, e, shell).dot(e) + shell.barrier[t] * barrier(f.spread)[0]
            elastic += shell.rest_area[t] * stored
            half = 0.5 * (e[0] - e[1])
            greatest = 0.5 * (e[0] + e[1]) + ti.sqrt(half * half + 0.25 * e[2] * e[2])
            stretch = ti.max(stretch, ti.sqrt(ti.max(1.0 + 2.0 * greatest, 0.0)))
        for i in range(partition_start(partition, points), partition_start(partition + 1, points)):
            elastic += bending_energy(i, bent(i, shell, p.position), curvature(i, shell, p.position), shell)
        partitions[partition] = vec5(0.0, 0.0, elastic, 0.0, stretch)
    found = vec5(0.0, 0.0, 0.0, 0.0, 0.0)
    ti.loop_config(serialize=True)
    for partition in range(PARTITIONS):
        found[2] += partitions[partition][2]
        found[4] = ti.max(found[4], partitions[partition][4])
    return found
