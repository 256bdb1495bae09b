"""Signed distance to a shape and the direction out of it, on the device, in the shape's own frame.

Box, sphere, capsule, cylinder and torus lie about their centre, the axis along y; a plane's solid is y < 0. Any other
shape is a grid of distances. Distances are exact outside; a grid's are as good as interpolation.
"""

from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, vec3, vec4

PLANE, SPHERE, BOX, CAPSULE, CYLINDER, TORUS, GRID = range(7)


@ti.func
def distance_to_plane(p: vec3) -> vec4:
    """Unit normal in xyz and signed distance [m] in w, as all of these return them."""
    return vec4(0.0, 1.0, 0.0, p[1])


@ti.func
def distance_to_sphere(p: vec3, radius: ti.f64) -> vec4:
    """At the centre, where all directions are as good, the normal is along y."""
    length = p.norm()
    normal = vec3(0.0, 1.0, 0.0)
    if length > 0.0:
        normal = p / length
    return vec4(normal[0], normal[1], normal[2], length - radius)


@ti.func
def distance_to_box(p: vec3, half: vec3) -> vec4:
    """Out of the nearest face where `p` is inside."""
    beyond = abs(p) - half
    outside = ti.max(beyond, 0.0)
    distance = outside.norm()
    normal = vec3(0.0)
    if distance > 0.0:
        normal = outside / distance
    else:
        axis = 0
        if beyond[1] > beyond[0]:
            axis = 1
        if beyond[2] > ti.max(beyond[0], beyond[1]):
            axis = 2
        distance = beyond.max()
        for k in ti.static(range(3)):
            if k == axis:
                normal[k] = 1.0
    for k in ti.static(range(3)):
        if p[k] < 0.0:
            normal[k] = -normal[k]
    return vec4(normal[0], normal[1], normal[2], distance)


@ti.func
def distance_to_capsule(p: vec3, radius: ti.f64, half_length: ti.f64) -> vec4:
    """As to a sphere about the nearest point of the axis, whose ends are at +-half_length [m]."""
    along = ti.min(ti.max(p[1], -half_length), half_length)
    return distance_to_sphere(p - vec3(0.0, along, 0.0), radius)


@ti.func
def distance_to_cylinder(p: vec3, radius: ti.f64, half_length: ti.f64) -> vec4:
    """From the rim where `p` is beyond both side and end, else from the one of the two that it is less deep behind."""
    across = ti.sqrt(p[0] * p[0] + p[2] * p[2])
    outward = vec3(1.0, 0.0, 0.0)
    if across > 0.0:
        outward = vec3(p[0] / across, 0.0, p[2] / across)
    up = vec3(0.0, 1.0, 0.0)
    if p[1] < 0.0:
        up = -up
    around, above = across - radius, abs(p[1]) - half_length
    distance, normal = ti.max(around, above), outward
    if above > around:
        normal = up
    if around > 0.0 and above > 0.0:
        distance = ti.sqrt(around * around + above * above)
        normal = (around * outward + above * up) / distance
    return vec4(normal[0], normal[1], normal[2], distance)


@ti.func
def distance_to_torus(p: vec3, radius: ti.f64, tube: ti.f64) -> vec4:
    """As to a sphere of radius `tube` [m] about the nearest point of the circle of `radius` [m] about y."""
    across = ti.sqrt(p[0] * p[0] + p[2] * p[2])
    middle = vec3(radius, 0.0, 0.0)
    if across > 0.0:
        middle = vec3(p[0], 0.0, p[2]) * (radius / across)
    return distance_to_sphere(p - middle, tube)


@ti.func
def distance_on_grid(p: vec3, grid: Integers, frame: Numbers, values: ti.template(), body: ti.i32) -> vec4:
    """By trilinear interpolation, its gradient for the normal; beyond the grid, as far as it is to the grid more.

    grid: per body where its values begin and how many there are along x, y and z; frame: per body the grid's low
    corner [m] and its cell [m].
    """
    first = grid[4 * body]
    nx, ny, nz = grid[4 * body + 1], grid[4 * body + 2], grid[4 * body + 3]
    low = vec3(frame[4 * body], frame[4 * body + 1], frame[4 * body + 2])
    cell = frame[4 * body + 3]
    most = vec3(ti.cast(nx - 1, ti.f64), ti.cast(ny - 1, ti.f64), ti.cast(nz - 1, ti.f64))
    u = ti.min(ti.max((p - low) / cell, 0.0), most)
    beyond = p - low - u * cell
    i = ti.min(ti.cast(ti.floor(u[0]), ti.i32), nx - 2)
    j = ti.min(ti.cast(ti.floor(u[1]), ti.i32), ny - 2)
    k = ti.min(ti.cast(ti.floor(u[2]), ti.i32), nz - 2)
    s = u - vec3(ti.cast(i, ti.f64), ti.cast(j, ti.f64), ti.cast(k, ti.f64))
    value, slope = ti.cast(0.0, ti.f64), vec3(0.0)
    for a, b, c in ti.static(ti.ndrange(2, 2, 2)):
        corner = ti.cast(values[first + ((i + a) * ny + j + b) * nz + k + c], ti.f64)
        x, y, z = s
        if ti.static(a == 0):
            x = 1.0 - x
        if ti.static(b == 0):
            y = 1.0 - y
        if ti.static(c == 0):
            z = 1.0 - z
        value += corner * x * y * z
        slope += corner * vec3((2 * a - 1) * y * z, (2 * b - 1) * x * z, (2 * c - 1) * x * y)
    if beyond.norm_sqr() > 0.0:
        slope = slope.normalized(1e-30) * value + beyond
        value = slope.norm()
    normal = vec3(0.0, 1.0, 0.0)
    if slope.norm() > 0.0:
        normal = slope.normalized()
    return vec4(normal[0], normal[1], normal[2], value)
