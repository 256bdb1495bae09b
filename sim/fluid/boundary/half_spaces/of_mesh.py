"""The faces of a mesh that a particle is before: several in a hollow edge or corner.

Where a surface bulges, the half-space that nodes see furthest ahead is the one that counts; where it is hollow, as in
the valleys of a scan, the nearest, as long as nothing that bulges hides it. What nodes a cell off see is believed only
where three of them see the same plane.
"""

from sim.device.arrays import real, vec3, vec4
from sim.device.compiler import ti
from sim.device.double import vec3 as vec3d
from sim.fluid.boundary.half_spaces.band import FAR, ON, SEEN, around_of, cell_of, corner_of, is_of, node_at
from sim.geometry.distance.narrow_band import OPPOSITE

NEARER = 0.1
"""Cells by which a face may seem nearer than what nodes know to be the least distance."""
BENT = 0.85
"""Cosine of the angle between two normals up to which they belong to two faces. Of a second one that is turned less
next to nothing counts (`sim.fluid.boundary.face_sums.place`), so that one that comes and goes does little."""
SAME, EVEN, AGREEING = 0.99999, 0.002, 3
"""Cosine between normals, and cells between offsets, of what two nodes see as one plane; and how many have to."""


@ti.func
def mesh_half_spaces(
    s: ti.i32,
    p: vec3d,
    side: real,
    reach: real,
    solids: ti.template(),
):
    """Normals and offsets of up to three half-spaces of a band that p is before, or FAR: of a thin wall that on this
    side of it, and where faces meet in a hollow edge or corner each of them that is within `reach` [m]."""
    second, third = vec4(0.0, 1.0, 0.0, FAR), vec4(0.0, 1.0, 0.0, FAR)
    first, least, outside = mesh_half_space(s, p, side, solids)
    if first.w < FAR and least < reach:
        first = nearer_in_a_hollow(s, p, side, first, least, outside, solids)
        beside = first.xyz
        # A loop of two, so that the search is compiled once.
        for further in range(2):
            if further == 0 or second.w < FAR:
                found = across_an_edge(s, p, side, reach, first, second, beside, least, outside, solids)
                if further == 0:
                    second = found
                    beside += ti.select(found.w < FAR, found.xyz, 0.0)
                else:
                    third = found
    return first, second, third


@ti.func
def mesh_half_space(
    s: ti.i32,
    p: vec3d,
    side: real,
    solids: ti.template(),
):
    """The half-space that p is before, whatever it is hollow towards, or FAR; the least that the distance can be [m];
    and whether p is on this side of the surface as far as nodes tell."""
    first, least, outside = nearest(s, p, side, solids)
    ahead = first.xyz.dot(ti.cast(p, real)) - first.w
    if first.w < FAR and (ahead < 0.0 or not outside):
        around = nearest_around(s, p, side, solids)
        if around.w < FAR:
            first, outside = around, True
    return first, least, outside


@ti.func
def nearest(
    s: ti.i32,
    p: vec3d,
    side: real,
    solids: ti.template(),
):
    """The half-space that the nodes of the cell around p see furthest ahead of it, of those on this side of the surface
    if there are any, but no further than the nearest point of it that they know; the least that the distance can be
    [m], by these nodes; and whether one of them is on this side."""
    cell, x = ti.cast(solids.frame[s, 3], real), ti.cast(p, real)
    found, least, outside = vec4(0.0, 1.0, 0.0, FAR), ti.cast(-FAR, real), False
    corner, inside, within = cell_of(s, p, solids)
    if within:
        most = ti.cast(FAR, real)
        for k in range(8):
            place = node_at(s, corner + corner_of(k), solids)
            if place >= 0:
                node = side * solids.nodes[place]
                displacement = cell * (inside - ti.cast(corner_of(k), real))
                # Nowhere does a distance change by more than the way.
                least = ti.max(least, node.w - displacement.norm())
                beyond = node.w > -ON * cell
                if beyond and not outside:
                    outside, most = True, ti.cast(FAR, real)
                if beyond == outside:
                    most = ti.min(most, (displacement + node.w * node.xyz).norm())
        ahead = ti.cast(-FAR, real)
        for k in range(8):
            place = node_at(s, corner + corner_of(k), solids)
            if place >= 0:
                node = side * solids.nodes[place]
                there = node.w + cell * node.xyz.dot(inside - ti.cast(corner_of(k), real))
                if (node.w > -ON * cell) == outside and there > ahead and there < most + ON * cell:
                    ahead = there
                    found = vec4(node.xyz, node.xyz.dot(x) - there)
    return found, least, outside


@ti.func
def nearer_in_a_hollow(
    s: ti.i32,
    p: vec3d,
    side: real,
    first: vec4,
    least_known: real,
    outside: bool,
    solids: ti.template(),
) -> vec4:
    """Of the half-spaces that the nodes of the cell around p see beside the first, the nearest that it is hollow
    towards: between the walls of a cleft, too, which both are on this side."""
    cell, x = ti.cast(solids.frame[s, 3], real), ti.cast(p, real)
    corner, inside, _ = cell_of(s, p, solids)
    ahead = first.xyz.dot(x) - first.w
    found, least = first, ahead
    for k in range(8):
        place = node_at(s, corner + corner_of(k), solids)
        if place >= 0:
            node = side * solids.nodes[place]
            displacement = inside - ti.cast(corner_of(k), real)
            there = node.w + cell * node.xyz.dot(displacement)
            known = there > least_known - NEARER * cell and outside == (node.w > -ON * cell)
            plane = ahead - cell * first.xyz.dot(displacement)
            closer = known and node.w < plane - SEEN * cell and there >= 0.0 and there < least
            if closer and not is_hidden(s, p, node, cell * displacement, side, outside, solids):
                found, least = vec4(node.xyz, node.xyz.dot(x) - there), there
    return found


@ti.func
def is_hidden(
    s: ti.i32,
    p: vec3d,
    node: vec4,
    displacement: vec3,
    side: real,
    outside: bool,
    solids: ti.template(),
):
    """Whether the surface is not there where p, `displacement` [m] from a `node`, is nearest to the half-space that
    this sees, its foot. Another node of the cell around p or the foot is nearer to that than to the surface; or it sees
    one that the foot is ahead of, and the surface bulges between them, each node nearer to the other's half-space than
    to its own. So the rim hides a wall from above."""
    cell = ti.cast(solids.frame[s, 3], real)
    to_foot = -(node.w + node.xyz.dot(displacement)) * node.xyz
    hidden = False
    for at in range(2):
        moved = ti.cast(at, real) * to_foot
        corner, inside, within = cell_of(s, p + ti.cast(moved, ti.f64), solids)
        for k in range(8):
            if within and not hidden:
                place = node_at(s, corner + corner_of(k), solids)
                if place >= 0:
                    other = side * solids.nodes[place]
                    from_other = cell * (inside - ti.cast(corner_of(k), real)) + to_foot - moved
                    ahead = other.w + other.xyz.dot(from_other)
                    its = ahead - other.xyz.dot(displacement + to_foot)
                    bulges = other.w > SEEN * cell - node.xyz.dot(from_other) and node.w > its + SEEN * cell
                    hidden = ahead > SEEN * cell and bulges and outside == (other.w > -ON * cell)
                    hidden = hidden or other.w > from_other.norm() + NEARER * cell
    return hidden


@ti.func
def nearest_around(
    s: ti.i32,
    p: vec3d,
    side: real,
    solids: ti.template(),
) -> vec4:
    """The nearest half-space that p is before by the nodes of the 27 cells around, or FAR: in a corner between thin
    walls no node of the cell itself needs to be on this side of them."""
    cell, x = ti.cast(solids.frame[s, 3], real), ti.cast(p, real)
    found, least = vec4(0.0, 1.0, 0.0, FAR), ti.cast(FAR, real)
    corner, inside, _ = cell_of(s, p, solids)
    for k in range(64):
        offset = around_of(k)
        place = node_at(s, corner + offset, solids)
        if place >= 0:
            node = side * solids.nodes[place]
            there = node.w + cell * node.xyz.dot(inside - ti.cast(offset, real))
            if node.w > 0.0 and there >= 0.0 and there < least:
                front = vec4(node.xyz, node.xyz.dot(x) - there)
                if is_face(s, p, front, vec3(0.0), side, solids):
                    found, least = front, there
    return found


@ti.func
def across_an_edge(
    s: ti.i32,
    p: vec3d,
    side: real,
    reach: real,
    first: vec4,
    second: vec4,
    beside: vec3,
    least_known: real,
    outside: bool,
    solids: ti.template(),
) -> vec4:
    """The nearest half-space within `reach` [m] on the other side of a hollow edge from the first, and of one from the
    second if there is one, or FAR; `beside`: the sum of their normals. Nodes a cell off in that direction are asked,
    too: those next to p may all be nearer to the faces that are known."""
    cell, x = ti.cast(solids.frame[s, 3], real), ti.cast(p, real)
    found, least = vec4(0.0, 1.0, 0.0, FAR), ti.cast(FAR * FAR, real)
    corner, inside, _ = cell_of(s, p, solids)
    ahead = first.xyz.dot(x) - first.w
    away = ti.floor(inside + beside, ti.i32)
    for k in range(16):
        offset = corner_of(k) if k < 8 else away + corner_of(k - 8)
        place = node_at(s, corner + offset, solids)
        if place >= 0:
            node = side * solids.nodes[place]
            displacement = inside - ti.cast(offset, real)
            there = node.w + cell * node.xyz.dot(displacement)
            like, other = node.xyz.dot(first.xyz), node.xyz.dot(second.xyz)
            plane = ahead - cell * first.xyz.dot(displacement)
            known = there > least_known - NEARER * cell and outside == (node.w > -ON * cell)
            new = like > OPPOSITE and (second.w >= FAR or (other > OPPOSITE and other < BENT))
            rank = ti.select(there < 0.0, -FAR * there, there)
            likely = known and new and there < reach and rank < least and is_hollow(like, node.w, plane, cell)
            if likely and not is_hidden(s, p, node, cell * displacement, side, outside, solids):
                front = vec4(node.xyz, node.xyz.dot(x) - there)
                flat = k < 8 or is_flat(s, corner + away, corner + offset, solids, cell)
                if flat and is_face(s, p, front, beside, side, solids):
                    found, least = front, rank
    return found


@ti.func
def is_flat(
    s: ti.i32,
    corner: ti.types.vector(3, ti.i32),
    one: ti.types.vector(3, ti.i32),
    solids: ti.template(),
    cell: real,
):
    """Whether others of the nodes around the cell at `corner` see the plane that one of its nodes sees: what is a cell
    off tells nothing of the surface next to p where that is bent, as on a scan."""
    node = solids.nodes[node_at(s, one, solids)]
    same = 0
    for k in range(64):
        there = corner + around_of(k)
        place = node_at(s, there, solids)
        if place >= 0:
            other = solids.nodes[place]
            step = other.w - node.w - cell * node.xyz.dot(ti.cast(there - one, real))
            same += ti.cast(other.xyz.dot(node.xyz) > SAME and ti.abs(step) < EVEN * cell, ti.i32)
    return same >= AGREEING


@ti.func
def is_hollow(like: real, distance: real, plane: real, cell: real):
    """Whether a node sees another face, by the cosine `like` of the angle between the two, across a hollow edge: its
    distance [m] is less than that to the `plane` of the first, and not more, as across an edge that bulges."""
    return like < BENT and distance < plane - SEEN * cell


@ti.func
def is_face(
    s: ti.i32,
    p: vec3d,
    front: vec4,
    beside: vec3,
    side: real,
    solids: ti.template(),
):
    """Whether the surface is there where p is nearest to this half-space, and not only its plane; or a cell further
    from the faces at whose edge that is: nodes in the edge see those."""
    cell = ti.cast(solids.frame[s, 3], real)
    distance = front.xyz.dot(ti.cast(p, real)) - front.w
    found = False
    for away in range(2):
        shift = (0.5 * cell - distance) * front.xyz + away * cell * beside
        corner, inside, within = cell_of(s, p + ti.cast(shift, ti.f64), solids)
        if within and not found:
            above = 0.5 * cell + away * cell * front.xyz.dot(beside)
            for k in range(8):
                place = node_at(s, corner + corner_of(k), solids)
                if place >= 0:
                    node = side * solids.nodes[place]
                    plane = above - cell * front.xyz.dot(inside - ti.cast(corner_of(k), real))
                    found = found or is_of(node, front.xyz, plane, cell)
    return found
