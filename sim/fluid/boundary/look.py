"""Which half-space a solid is to a particle: unit normal and distance of the nearest point of its surface.

Where a surface bulges, less of it is near than of a plane at the same distance: the distance is longer by what makes
the density right (`sim.fluid.calibration.curvature_shift`). A thin wall has two sides. Each particle sees the one that
it is on: with `near`, the half-space that it saw before, the other side does not count, and where there is nothing else
the half-space goes on as it was.
"""

import taichi as ti

from sim.arrays import DoubleTable, IntArray, IntTable, RealArray, Vec4Array, real, vec3, vec4
from sim.double import vec3 as vec3d
from sim.double import vec4 as vec4d
from sim.geometry.fields import (
    BOX,
    CAPSULE,
    CYLINDER,
    GRID,
    PLANE,
    SPHERE,
    TORUS,
    distance_to_box,
    distance_to_capsule,
    distance_to_cylinder,
    distance_to_plane,
    distance_to_sphere,
    distance_to_torus,
)
from sim.geometry.narrow_band import BLOCK, OPPOSITE, TURNED

FAR = 1e10
SEEN = 0.05
"""Cells by which two faces have to differ in distance at a node for their edge to be seen."""
ALIKE = 0.25
"""Cells by which what a node sees may differ from a plane that is the same face: faces may be curved."""
NEARER = 0.1
"""Cells by which a face may seem nearer than what nodes know to be the least distance."""
CURVED = sum(1 << kind for kind in (SPHERE, BOX, CAPSULE, CYLINDER, TORUS))
"""Bits of the primitives that end."""


@ti.func
def to_own(s: ti.i32, x: vec3, pose: DoubleTable) -> vec3d:
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


@ti.func
def look(
    s: ti.i32,
    p: vec3d,
    near: vec4,
    kind: IntArray,
    size: Vec4Array,
    shift: ti.types.vector(2, real),
    kinds: ti.template(),
    frame: DoubleTable,
    lattice: IntTable,
    table: IntArray,
    nodes: Vec4Array,
    bend: RealArray,
) -> vec4:
    """Unit normal and distance [m] of a solid at p, both in its own frame; `near`: normal and offset there of the
    half-space that it was before; kinds: a bit for each kind that there is."""
    found = vec4(0.0, 1.0, 0.0, FAR)
    if kind[s] == GRID:
        if ti.static(kinds >> GRID & 1):
            if near.w < FAR:
                found = on_band(s, p, size[s].w, near, shift, frame, lattice, table, nodes, bend)
    else:
        found = on_form(s, p, kind, size, shift, kinds)
        if kind[s] != PLANE and found.xyz.dot(near.xyz) < OPPOSITE:
            found = vec4(near.xyz, near.xyz.dot(ti.cast(p, real)) - near.w)
    return found


@ti.func
def on_form(
    s: ti.i32,
    p: vec3d,
    kind: IntArray,
    size: Vec4Array,
    shift: ti.types.vector(2, real),
    kinds: ti.template(),
) -> vec4:
    """Unit normal and distance [m] of a plane or primitive at p, on whichever side that is."""
    found = vec4(0.0, 1.0, 0.0, FAR)
    if ti.static(kinds >> PLANE & 1):
        if kind[s] == PLANE:
            found = ti.cast(distance_to_plane(p), real)
    if ti.static(kinds & CURVED):
        if kind[s] != PLANE and kind[s] != GRID:
            found = on_primitive(kind[s], p, size[s], kinds, shift)
    return found


@ti.func
def half_spaces(
    s: ti.i32,
    p: vec3d,
    kind: IntArray,
    size: Vec4Array,
    shift: ti.types.vector(2, real),
    kinds: ti.template(),
    frame: DoubleTable,
    lattice: IntTable,
    table: IntArray,
    nodes: Vec4Array,
):
    """Normals and offsets of up to three half-spaces that a solid is to p, whatever it was before; FAR where it is
    none."""
    first, second, third = vec4(0.0, 1.0, 0.0, FAR), vec4(0.0, 1.0, 0.0, FAR), vec4(0.0, 1.0, 0.0, FAR)
    if kind[s] == GRID:
        if ti.static(kinds >> GRID & 1):
            first, second, third = fronts(s, p, size[s].w, frame, lattice, table, nodes)
    else:
        one = on_form(s, p, kind, size, shift, kinds)
        first = vec4(one.xyz, one.xyz.dot(ti.cast(p, real)) - one.w)
    return first, second, third


@ti.func
def on_primitive(what: ti.i32, p: vec3d, half: vec4, kinds: ti.template(), shift: ti.types.vector(2, real)) -> vec4:
    """In closed form; only the kinds that a scene has are compiled."""
    first, second = ti.cast(half.x, ti.f64), ti.cast(half.y, ti.f64)
    found = vec4d(0.0)
    if ti.static(kinds >> SPHERE & 1):
        if what == SPHERE:
            found = distance_to_sphere(p, first)
    if ti.static(kinds >> BOX & 1):
        if what == BOX:
            found = distance_to_box(p, ti.cast(half.xyz, ti.f64))
    if ti.static(kinds >> CAPSULE & 1):
        if what == CAPSULE:
            found = distance_to_capsule(p, first, second)
    if ti.static(kinds >> CYLINDER & 1):
        if what == CYLINDER:
            found = distance_to_cylinder(p, first, second)
    if ti.static(kinds >> TORUS & 1):
        if what == TORUS:
            found = distance_to_torus(p, first, second)
    one = ti.cast(found, real)
    curvature = half.w * curvature_of(what, half, ti.cast(p, real), one.xyz, one.w)
    return vec4(half.w * one.xyz, half.w * one.w + shift_of(curvature, half.w * one.w, shift))


@ti.func
def cell_of(s: ti.i32, p: vec3d, frame: DoubleTable, lattice: IntTable):
    """The cell of a band that p is in, where in it from 0 to 1, and whether there is one."""
    u = vec3(0.0)
    for axis in ti.static(range(3)):
        u[axis] = ti.cast((p[axis] - frame[s, axis]) / frame[s, 3], real)
    corner = ti.floor(u, ti.i32)
    within = corner.min() >= 0
    for axis in ti.static(range(3)):
        within = within and corner[axis] + 1 < lattice[s, 1 + axis] * BLOCK
    return corner, u - ti.cast(corner, real), within


@ti.func
def fronts(
    s: ti.i32,
    p: vec3d,
    side: real,
    frame: DoubleTable,
    lattice: IntTable,
    table: IntArray,
    nodes: Vec4Array,
):
    """Normals and offsets of up to three half-spaces of a band that p is before, or FAR: of a thin wall that on this
    side of it, and where faces meet in a hollow edge or corner each of them."""
    first, second, third = vec4(0.0, 1.0, 0.0, FAR), vec4(0.0, 1.0, 0.0, FAR), vec4(0.0, 1.0, 0.0, FAR)
    cell, x = ti.cast(frame[s, 3], real), ti.cast(p, real)
    corner, inside, within = cell_of(s, p, frame, lattice)
    if within:
        ahead, outside = ti.cast(-FAR, real), False
        # Nowhere does a distance change by more than the way.
        least_known = ti.cast(-FAR, real)
        for k in range(8):
            place = _place(s, corner + _corner(k), lattice, table)
            if place >= 0:
                node = side * nodes[place]
                way = inside - ti.cast(_corner(k), real)
                there = node.w + cell * node.xyz.dot(way)
                least_known = ti.max(least_known, node.w - cell * way.norm())
                beyond = node.w > -SEEN * cell
                if (there > ahead and outside == beyond) or (beyond and not outside):
                    ahead, outside = there, outside or beyond
                    first = vec4(node.xyz, node.xyz.dot(x) - there)
        for _ in range(2):
            found, least = vec4(0.0, 1.0, 0.0, FAR), ti.cast(FAR, real)
            for k in range(16):
                offset = _corner(k) if k < 8 else 3 * _corner(k - 8) - 1
                place = _place(s, corner + offset, lattice, table)
                if place >= 0 and first.w < FAR:
                    node = side * nodes[place]
                    way = inside - ti.cast(offset, real)
                    there = node.w + cell * node.xyz.dot(way)
                    like = node.xyz.dot(first.xyz)
                    plane = ahead - cell * first.xyz.dot(way)
                    known = there > least_known - NEARER * cell
                    if like > OPPOSITE and known and there < least and is_hollow(like, node.w, plane, cell):
                        if second.w >= FAR or node.xyz.dot(second.xyz) < TURNED:
                            front = vec4(node.xyz, node.xyz.dot(x) - there)
                            if is_face(s, p, front, side, frame, lattice, table, nodes):
                                found, least = front, there
            if second.w >= FAR:
                second = found
            else:
                third = found
    return first, second, third


@ti.func
def is_hollow(like: real, distance: real, plane: real, cell: real):
    """Whether a node sees another face, by the cosine `like` of the angle between the two, across a hollow edge: its
    distance [m] is less than that to the `plane` of the first, and not more, as across an edge that bulges."""
    return like < TURNED and distance < plane - SEEN * cell


@ti.func
def is_face(
    s: ti.i32,
    p: vec3d,
    front: vec4,
    side: real,
    frame: DoubleTable,
    lattice: IntTable,
    table: IntArray,
    nodes: Vec4Array,
):
    """Whether the surface is there where p is nearest to this half-space, and not only its plane."""
    cell = ti.cast(frame[s, 3], real)
    distance = front.xyz.dot(ti.cast(p, real)) - front.w
    foot = p - ti.cast((distance - 0.5 * cell) * front.xyz, ti.f64)
    corner, inside, within = cell_of(s, foot, frame, lattice)
    found = False
    if within:
        for k in range(8):
            place = _place(s, corner + _corner(k), lattice, table)
            if place >= 0:
                node = side * nodes[place]
                plane = 0.5 * cell - cell * front.xyz.dot(inside - ti.cast(_corner(k), real))
                found = found or is_of(node, front.xyz, plane, cell)
    return found


@ti.func
def is_of(node: vec4, normal: vec3, plane: real, cell: real):
    """Whether a node sees the half-space with this normal, whose `plane` is so far from it [m]."""
    return node.xyz.dot(normal) > TURNED and ti.abs(node.w - plane) < ALIKE * cell


@ti.func
def share_of_node(way: vec3) -> real:
    """Weight of a node in trilinear interpolation, `way` cells from it; never quite none."""
    beside = 1.0 - ti.abs(way)
    return 1e-6 + beside.x * beside.y * beside.z


@ti.func
def on_band(
    s: ti.i32,
    p: vec3d,
    side: real,
    near: vec4,
    shift: ti.types.vector(2, real),
    frame: DoubleTable,
    lattice: IntTable,
    table: IntArray,
    nodes: Vec4Array,
    bend: RealArray,
) -> vec4:
    """From the nodes about p: each tells the half-space that it sees, and those that see the side `near` are weighted
    as in trilinear interpolation. Half of the way that is left from a node to p is what interpolation itself makes of a
    curved surface; so the two errors of second order cancel. In a hollow edge only nodes that see the same face count.
    """
    cell = ti.cast(frame[s, 3], real)
    found = vec4(0.0, 1.0, 0.0, FAR)
    corner, inside, within = cell_of(s, p, frame, lattice)
    if within:
        known, seen, own = ti.cast(0.0, real), ti.cast(0.0, real), ti.cast(0.0, real)
        curvature, hollow = ti.cast(0.0, real), False
        ahead_of = near.xyz.dot(ti.cast(p, real)) - near.w
        straight, bent, of_face = vec4(0.0), vec4(0.0), vec4(0.0)
        for k in range(8):
            offset = _corner(k)
            place = _place(s, corner + offset, lattice, table)
            if place >= 0:
                node = side * nodes[place]
                way = inside - ti.cast(offset, real)
                share = share_of_node(way)
                rise = cell * node.xyz.dot(way)
                known += share
                like = node.xyz.dot(near.xyz)
                plane = ahead_of - cell * near.xyz.dot(way)
                hollow = hollow or (like > OPPOSITE and is_hollow(like, node.w, plane, cell))
                if like > OPPOSITE and not (like < TURNED and node.w < plane + SEEN * cell):
                    ahead = vec4(node.xyz, node.w + rise)
                    straight += share * ahead
                    bent += share * vec4(node.xyz, node.w + 0.5 * rise)
                    curvature += share * side * bend[place]
                    seen += share
                    if is_of(node, near.xyz, plane, cell):
                        of_face += share * ahead
                        own += share
        if known > 0.99 and seen > 0.0 and (own > 0.0 or not hollow):
            sum_of, total = straight, seen
            if seen > 0.999 * known:
                sum_of = bent
            if hollow:
                sum_of, total, curvature = of_face, own, 0.0
            length = sum_of.xyz.norm()
            if length > 1e-3 * total:
                distance = sum_of.w / total
                found = vec4(sum_of.xyz / length, distance + shift_of(curvature / total, distance, shift))
    if found.w >= FAR or found.xyz.dot(near.xyz) < OPPOSITE:
        found = vec4(near.xyz, near.xyz.dot(ti.cast(p, real)) - near.w)
    return found


@ti.func
def _corner(k: ti.i32) -> ti.types.vector(3, ti.i32):
    """The k-th corner of a cell."""
    return ti.Vector([k & 1, k >> 1 & 1, k >> 2])


@ti.func
def _place(s: ti.i32, node: ti.types.vector(3, ti.i32), lattice: IntTable, table: IntArray) -> ti.i32:
    """Of a node in the tables of all; -1 where there is none."""
    block = node // BLOCK
    inner = node - BLOCK * block
    row = -1
    if node.min() >= 0 and block.x < lattice[s, 1] and block.y < lattice[s, 2] and block.z < lattice[s, 3]:
        row = table[lattice[s, 0] + (block.x * lattice[s, 2] + block.y) * lattice[s, 3] + block.z]
    return ti.select(row >= 0, ((row * BLOCK + inner.x) * BLOCK + inner.y) * BLOCK + inner.z, -1)
