"""Mean curvature of the surfaces of primitives, and what it makes of the distance to any surface."""

from sim.device.arrays import real, vec3, vec4
from sim.device.compiler import ti
from sim.geometry.distance.sdf import BOX, CAPSULE, CYLINDER, SPHERE, TORUS


@ti.func
def shift_of(curvature: real, distance: real, shift: ti.types.vector(2, real)) -> real:
    """By how much further a surface of this mean curvature [1/m] seems to be at this distance [m]: not at all on the
    surface itself, which is to hold a single particle."""
    bulging = ti.min(curvature, 1.0 / shift.y)
    off = ti.math.clamp(2.0 * distance / shift.y, 0.0, 1.0)
    hollow = curvature / (1.0 - 0.5 * ti.min(curvature, 0.0) * shift.y)
    return shift.x * off * ti.select(curvature > 0, bulging, hollow)


@ti.func
def rounded(turned: real) -> real:
    """How far the surface is seen across an edge or corner, from 0 on its faces to 1 in the middle: what it lacks there
    must not come at once, or what goes around an edge would be pushed off."""
    left = 1.0 - ti.min(turned, 1.0)
    return 1.0 - left * left


@ti.func
def curvature_of(kind: ti.i32, size: vec4, p: vec3, n: vec3, distance: real) -> real:
    """Mean curvature [1/m] of the level set of the distance to a primitive, outside of it."""
    away = ti.max(distance, 1e-6)
    across = ti.max(ti.sqrt(p.x * p.x + p.z * p.z), 1e-6)
    double = ti.cast(0.0, real)
    if kind == SPHERE:
        double = 2.0 / ti.max(size.x + distance, 1e-6)
    elif kind == BOX:
        x, y, z = n.x * n.x, n.y * n.y, n.z * n.z
        double = (rounded(4.0 * (x * y + y * z + z * x)) + rounded(27.0 * x * y * z)) / away
    elif kind == CAPSULE:
        double = ti.select(ti.abs(p.y) > size.y, 2.0, 1.0) / ti.max(size.x + distance, 1e-6)
    elif kind == CYLINDER:
        radial = ti.sqrt(n.x * n.x + n.z * n.z)
        double = radial / across + rounded(4.0 * radial * radial * n.y * n.y) / away
    elif kind == TORUS:
        double = 1.0 / ti.max(size.y + distance, 1e-6) + (n.x * p.x + n.z * p.z) / (across * across)
    return 0.5 * double
