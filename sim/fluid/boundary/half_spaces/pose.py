"""Between the frame of a solid and that of the fluid, by the solid's row of POSE numbers
(`sim.fluid.boundary.shapes`)."""

from sim.device.arrays import DoubleTable, real, vec3
from sim.device.compiler import ti
from sim.device.double import vec3 as vec3d


@ti.func
def to_local(s: ti.i32, x: vec3, pose: DoubleTable) -> vec3d:
    """A point in the frame of a solid."""
    d = vec3d(0.0)
    for row in ti.static(range(3)):
        d[row] = ti.cast(x[row], ti.f64) - pose[s, 9 + row]
    own = vec3d(0.0)
    for column in ti.static(range(3)):
        for row in ti.static(range(3)):
            own[column] += pose[s, 3 * row + column] * d[row]
    return own


@ti.func
def to_world(s: ti.i32, n: vec3, pose: DoubleTable) -> vec3:
    """A direction in the frame of a solid, in that of the fluid."""
    turned = vec3(0.0)
    for row in ti.static(range(3)):
        for column in ti.static(range(3)):
            turned[row] += ti.cast(pose[s, 3 * row + column], real) * n[column]
    return turned


@ti.func
def surface_velocity(s: ti.i32, x: vec3, pose: DoubleTable) -> vec3:
    """Of a solid, as far as its motion would take it at x [m/s]."""
    arm, speed, turning = vec3(0.0), vec3(0.0), vec3(0.0)
    for axis in ti.static(range(3)):
        arm[axis] = x[axis] - ti.cast(pose[s, 18 + axis], real)
        speed[axis] = ti.cast(pose[s, 12 + axis], real)
        turning[axis] = ti.cast(pose[s, 15 + axis], real)
    return speed + turning.cross(arm)
