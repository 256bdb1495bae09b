"""What `sim.coupling.fluid_cloth.wet_cloth` does to all points of a cloth, on the device."""

from sim.cloth.fabric.layout import Points
from sim.device.compiler import ti
from sim.device.double import Vectors


@ti.kernel
def shift(points: ti.i32, factor: ti.f64, displacement: Vectors, place: Vectors):
    """Move points on by a factor of these ways [m]."""
    for i in range(points):
        place[i] += factor * displacement[i]


@ti.kernel
def strike(points: ti.i32, dt: ti.f64, p: Points, load: Vectors):
    """Change velocities by forces [N] that act for dt [s]."""
    for i in range(points):
        if p.mobile[i]:
            p.velocity[i] += dt / p.mass[i] * load[i]


@ti.kernel
def speeds(points: ti.i32, dt: ti.f64, start: Vectors, place: Vectors, speed: Vectors):
    """Velocities [m/s] that take points from where they start to where they are tried."""
    for i in range(points):
        speed[i] = (place[i] - start[i]) / dt
