"""Air that drags on cloth: on each point as on a flat piece of the cloth's area around it.

Across, force = density/2 drag A |v_n| v_n, v_n the speed along the normal relative to the wind; along, the same with
the skin friction and the rest of the velocity. Both are linear in the velocity at the end of the step, with |v| from
its begin, so that no step is too long for them.
"""

import taichi as ti

from sim.cloth.layout import Points
from sim.double import Integers, Numbers, Vectors, vec3


@ti.kernel
def drag(
    points: ti.i32,
    wind: vec3,
    normal_factor: ti.f64,
    along_factor: ti.f64,
    corner: Integers,
    first: Integers,
    entry: Integers,
    p: Points,
    face: Vectors,
    across: Numbers,
    along: Numbers,
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
        face[i] = normal
        across[i] = normal_factor * size * abs(speed)
        along[i] = along_factor * size * (past - speed * normal).norm()
