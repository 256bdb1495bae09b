"""Air that drags on cloth: on each point as on a flat piece of the cloth's area around it.

Across, force = density/2 drag A |v_n| v_n, v_n the speed along the normal relative to the wind; along, the same with
the skin friction and the rest of the velocity. Both are linear in the velocity at the end of the step, with |v| from
its begin, so that no step is too long for them.
"""

from sim.cloth.fabric.layout import Drag, Points
from sim.device.compiler import ti
from sim.device.double import Integers, mat3, vec3


@ti.func
def drag(i: ti.i32, velocity: vec3, d: ti.template()) -> vec3:
    """What air takes from a point [N] at a velocity relative to it."""
    n = d.cloth_normal[i]
    return d.drag_along[i] * velocity + (d.drag_across[i] - d.drag_along[i]) * n.dot(velocity) * n


@ti.func
def drag_block(i: ti.i32, d: ti.template()) -> mat3:
    """How that changes with the velocity [kg/s]."""
    n, unit = d.cloth_normal[i], mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    return d.drag_along[i] * unit + (d.drag_across[i] - d.drag_along[i]) * n.outer_product(n)


@ti.func
def braked(i: ti.i32, mass: ti.f64, dt: ti.f64, momentum: vec3, wind: vec3, d: ti.template()) -> vec3:
    """Velocity with drag at the end of the step, from the momentum without."""
    unit, block = mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), drag_block(i, d)
    return (mass * unit + dt * block).inverse() @ (momentum + dt * (block @ wind))


@ti.kernel
def find_drag(
    points: ti.i32,
    wind: vec3,
    normal_factor: ti.f64,
    along_factor: ti.f64,
    corner: Integers,
    first: Integers,
    entry: Integers,
    p: Points,
    d: Drag,
):
    """Normals, and drag [kg/s] across and along the cloth; the factors are density/2 times the coefficients."""
    for i in range(points):
        area = vec3(0.0, 0.0, 0.0)
        for k in range(first[i], first[i + 1]):
            t = entry[k] // 3
            a, b, c = p.position[corner[3 * t]], p.position[corner[3 * t + 1]], p.position[corner[3 * t + 2]]
            area += (b - a).cross(c - a) / 6.0
        size = area.norm()
        normal = vec3(0.0, 0.0, 0.0)
        if size > 0.0:
            normal = area / size
        past = p.velocity[i] - wind
        speed = normal.dot(past)
        d.cloth_normal[i] = normal
        d.drag_across[i] = normal_factor * size * abs(speed)
        d.drag_along[i] = along_factor * size * (past - speed * normal).norm()
