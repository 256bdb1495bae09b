"""A mesh as the nodes of a narrow band tell of it: each the half-space that it sees
(`sim.geometry.distance.narrow_band`)."""

from sim.device.arrays import real, vec3, vec4
from sim.device.compiler import ti
from sim.device.double import vec3 as vec3d
from sim.fluid.boundary.half_spaces.curvature import shift_of
from sim.geometry.distance.narrow_band import BLOCK, OPPOSITE, TURNED

FAR = 1e10
SEEN = 0.05
"""Cells by which two faces have to differ in distance at a node for their edge to be seen."""
BITS = BLOCK.bit_length() - 1
ON = 1e-3
"""Cells behind the surface at which a node is on it yet: further in, it sees an edge where two faces are."""
ALIKE, ALIGNED = 0.25, 0.9
"""Cells by which what a node sees may differ from a plane that is the same face, and the least cosine of the angle
between their normals: faces may be curved."""


@ti.func
def cell_of(s: ti.i32, p: vec3d, solids: ti.template()):
    """The cell of a band that p is in, where in it from 0 to 1, and whether there is one."""
    u = vec3(0.0)
    for axis in ti.static(range(3)):
        u[axis] = ti.cast((p[axis] - solids.frame[s, axis]) / solids.frame[s, 3], real)
    corner = ti.floor(u, ti.i32)
    within = corner.min() >= 0
    for axis in ti.static(range(3)):
        within = within and corner[axis] + 1 < solids.lattice[s, 1 + axis] * BLOCK
    return corner, u - ti.cast(corner, real), within


@ti.func
def is_of(node: vec4, normal: vec3, plane: real, cell: real):
    """Whether a node sees the half-space with this normal, whose `plane` is so far from it [m]."""
    return node.xyz.dot(normal) > ALIGNED and ti.abs(node.w - plane) < ALIKE * cell


@ti.func
def share_of_node(displacement: vec3) -> real:
    """Weight of a node in trilinear interpolation, `displacement` cells from it; never quite none."""
    beside = 1.0 - ti.abs(displacement)
    return 1e-6 + beside.x * beside.y * beside.z


@ti.func
def on_band(
    s: ti.i32,
    p: vec3d,
    side: real,
    near: vec4,
    hollow: bool,
    solids: ti.template(),
) -> vec4:
    """From the nodes about p: each tells the half-space that it sees, and those that see the side `near` are weighted
    as in trilinear interpolation. Half of the way that is left from a node to p is what interpolation itself makes of a
    curved surface; so the two errors of second order cancel. In a hollow edge only nodes before it that see the same
    face count.
    """
    cell = ti.cast(solids.frame[s, 3], real)
    found = vec4(0.0, 1.0, 0.0, FAR)
    corner, inside, within = cell_of(s, p, solids)
    if within:
        known, seen, own = ti.cast(0.0, real), ti.cast(0.0, real), ti.cast(0.0, real)
        curvature = ti.cast(0.0, real)
        ahead_of = near.xyz.dot(ti.cast(p, real)) - near.w
        straight, bent, of_face = vec4(0.0), vec4(0.0), vec4(0.0)
        for k in range(8):
            offset = corner_of(k)
            place = node_at(s, corner + offset, solids)
            if place >= 0:
                node = side * solids.nodes[place]
                displacement = inside - ti.cast(offset, real)
                share = share_of_node(displacement)
                rise = cell * node.xyz.dot(displacement)
                known += share
                like = node.xyz.dot(near.xyz)
                plane = ahead_of - cell * near.xyz.dot(displacement)
                if like > OPPOSITE and not (like < TURNED and node.w < plane + SEEN * cell):
                    ahead = vec4(node.xyz, node.w + rise)
                    straight += share * ahead
                    bent += share * vec4(node.xyz, node.w + 0.5 * rise)
                    curvature += share * side * solids.bend[place]
                    seen += share
                    if node.w > -ON * cell and is_of(node, near.xyz, plane, cell):
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
                found = vec4(sum_of.xyz / length, distance + shift_of(curvature / total, distance, solids.shift))
    if found.w >= FAR or found.xyz.dot(near.xyz) < OPPOSITE:
        found = vec4(near.xyz, near.xyz.dot(ti.cast(p, real)) - near.w)
    return found


@ti.func
def corner_of(k: ti.i32) -> ti.types.vector(3, ti.i32):
    """The k-th corner of a cell."""
    return ti.Vector([k & 1, k >> 1 & 1, k >> 2])


@ti.func
def around_of(k: ti.i32) -> ti.types.vector(3, ti.i32):
    """The k-th of the 64 corners of a cell and of those around it."""
    return ti.Vector([k & 3, k >> 2 & 3, k >> 4]) - 1


@ti.func
def node_at(s: ti.i32, node: ti.types.vector(3, ti.i32), solids: ti.template()) -> ti.i32:
    """Of a node in the tables of all; -1 where there is none."""
    block, inner = node >> BITS, node & BLOCK - 1
    row = -1
    first, nx, ny, nz = solids.lattice[s, 0], solids.lattice[s, 1], solids.lattice[s, 2], solids.lattice[s, 3]
    if node.min() >= 0 and block.x < nx and block.y < ny and block.z < nz:
        row = solids.table[first + (block.x * ny + block.y) * nz + block.z]
    return ti.select(row >= 0, ((row * BLOCK + inner.x) * BLOCK + inner.y) * BLOCK + inner.z, -1)
