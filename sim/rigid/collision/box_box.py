"""Contacts of two boxes: the axis that separates them most, then the corners of the area where they meet.

Separating axes: Gottschalk et al. 1996.
"""

from typing import Any

from sim.device.compiler import ti
from sim.device.double import mat3, vec3
from sim.rigid.collision.manifold import FEW, add

FACES_FIRST = 0.02
"""Two edges have to be apart by this share of the size more than the faces are, to be what meets: they do so in one
point, and an edge that lies on a face needs two."""
PARALLEL = 1e-6
"""Squared sine of the angle below which edges are taken for parallel."""


@ti.func
def _column(matrix: mat3, index: ti.i32) -> vec3:
    return vec3(matrix[0, index], matrix[1, index], matrix[2, index])


@ti.func
def _extent(turn: mat3, half: vec3, axis: vec3) -> ti.f64:
    """Half of what a box takes up along an axis of unit length [m]."""
    return abs(turn.transpose() @ axis).dot(half)


Box: Any = ti.types.struct(x=vec3, turn=mat3, half=vec3)
"""Where its middle is [m], its axes in the world, and its half edges [m]."""


@ti.func
def box_box(first: ti.i32, a: Box, b: Box, margin: ti.f64, found: ti.template()) -> ti.i32:
    """Write contacts with a gap below `margin` [m] from index `first` on; returns their number, or -1 where the boxes
    are farther apart.

    Normals point from b to a. None are found where a corner is nearest to a corner or an edge.
    """
    size = 2.0 * ti.min(a.half.min(), b.half.min())
    away = a.x - b.x
    best, face, owner = ti.cast(-ti.math.inf, ti.f64), 0, 0
    normal = vec3(0.0)
    for which in range(6):
        axis = _column(a.turn, which % 3)
        if which >= 3:
            axis = _column(b.turn, which % 3)
        reach = _extent(a.turn, a.half, axis) + _extent(b.turn, b.half, axis)
        apart = abs(away.dot(axis)) - reach
        # The faces of a come first where both are as good, so that the choice does not flicker.
        head_start = 1e-6 * size if which >= 3 and owner == 0 else 0.0
        if apart > best + head_start:
            best, face, owner = apart, which % 3, which // 3
            normal = axis if away.dot(axis) >= 0.0 else -axis
    edge_a, edge_b, edges = 0, 0, 0
    across = best + FACES_FIRST * size
    for i in range(3):
        for j in range(3):
            axis = _column(a.turn, i).cross(_column(b.turn, j))
            if axis.norm_sqr() > PARALLEL:
                axis = axis.normalized()
                apart = abs(away.dot(axis)) - _extent(a.turn, a.half, axis) - _extent(b.turn, b.half, axis)
                if apart > across:
                    across, edge_a, edge_b, edges = apart, i, j, 1
                    normal = axis if away.dot(axis) >= 0.0 else -axis
    count = -1
    if edges == 1:
        if across < margin:
            count = _edges_meet(first, a, b, edge_a, edge_b, normal, size, found)
    elif best < margin:
        box, other, sign = a, b, -1.0
        if owner == 1:
            box, other, sign = b, a, 1.0
        count = _faces_meet(first, box, other, face, sign * normal, sign, margin, size, found)
    return count


@ti.func
def _edges_meet(
    first: ti.i32,
    a: Box,
    b: Box,
    edge_a: ti.i32,
    edge_b: ti.i32,
    normal: vec3,
    size: ti.f64,
    found: ti.template(),
) -> ti.i32:
    """Where the edge of a farthest against the normal and that of b farthest along it cross, if they do."""
    p, q = a.x, b.x
    for k in ti.static(range(3)):
        along_a, along_b = _column(a.turn, k), _column(b.turn, k)
        if k != edge_a:
            p -= along_a * a.half[k] * (1.0 if along_a.dot(normal) >= 0.0 else -1.0)
        if k != edge_b:
            q += along_b * b.half[k] * (1.0 if along_b.dot(normal) >= 0.0 else -1.0)
    u, v = _column(a.turn, edge_a), _column(b.turn, edge_b)
    d = q - p
    bend = u.dot(v)
    share = 1.0 - bend * bend
    s = (d.dot(u) - bend * d.dot(v)) / share
    t = (bend * d.dot(u) - d.dot(v)) / share
    reach_a, reach_b = a.half[edge_a], b.half[edge_b]
    count = 0
    if abs(s) <= reach_a and abs(t) <= reach_b:
        on_a, on_b = p + u * s, q + v * t
        gap = (on_a - on_b).dot(normal)
        count = add(first, 0, FEW, size, 0.5 * (on_a + on_b), normal, gap, 0.0, found)
    return count


@ti.func
def _faces_meet(
    first: ti.i32,
    box: Box,
    other: Box,
    face: ti.i32,
    out: vec3,
    sign: ti.f64,
    margin: ti.f64,
    size: ti.f64,
    found: ti.template(),
) -> ti.i32:
    """The corners of the area that a face with the normal `out` shares with the face of the other box against it."""
    u_axis, v_axis = (face + 1) % 3, (face + 2) % 3
    u, v = _column(box.turn, u_axis), _column(box.turn, v_axis)
    u_half, v_half = box.half[u_axis], box.half[v_axis]
    centre = box.x + out * box.half[face]
    facing, most = 0, ti.cast(-1.0, ti.f64)
    for k in range(3):
        steep = abs(_column(other.turn, k).dot(out))
        if steep > most:
            facing, most = k, steep
    against = _column(other.turn, facing)
    if against.dot(out) > 0.0:
        against = -against
    p_axis, q_axis = (facing + 1) % 3, (facing + 2) % 3
    p, q = _column(other.turn, p_axis), _column(other.turn, q_axis)
    p_half, q_half = other.half[p_axis], other.half[q_axis]
    middle = other.x + against * other.half[facing] - centre
    # Coordinates along u, v and out: of the other face's middle and of its two edges.
    mu, mv, mn = middle.dot(u), middle.dot(v), middle.dot(out)
    pu, pv, pn = p.dot(u), p.dot(v), p.dot(out)
    qu, qv, qn = q.dot(u), q.dot(v), q.dot(out)
    area = pu * qv - pv * qu
    tolerance = 1e-9 * size
    count = 0
    for candidate in range(24):
        # Of the four corners of either face and the sixteen crossings of their edges: along u and v, the gap, whether
        # it lies in both.
        cu, cv, gap, shared = mu, mv, mn, False
        if candidate < 8:
            i = ti.cast(1 - 2 * (candidate & 1), ti.f64)
            j = ti.cast(1 - (candidate & 2), ti.f64)
            if candidate < 4:
                cu += i * p_half * pu + j * q_half * qu
                cv += i * p_half * pv + j * q_half * qv
                gap += i * p_half * pn + j * q_half * qn
                shared = abs(cu) <= u_half + tolerance and abs(cv) <= v_half + tolerance
            elif abs(area) > 1e-12:
                cu, cv = i * u_half, j * v_half
                du, dv = cu - mu, cv - mv
                s, t = (du * qv - dv * qu) / area, (dv * pu - du * pv) / area
                gap += s * pn + t * qn
                shared = abs(s) <= p_half + tolerance and abs(t) <= q_half + tolerance
        else:
            edge, side = (candidate - 8) // 4, (candidate - 8) % 4
            i = ti.cast(1 - 2 * (edge & 1), ti.f64)
            j = ti.cast(1 - 2 * (side & 1), ti.f64)
            su, sv, sn, du, dv, dn, reach = i * p_half * pu, i * p_half * pv, i * p_half * pn, qu, qv, qn, q_half
            if edge >= 2:
                su, sv, sn, du, dv, dn, reach = i * q_half * qu, i * q_half * qv, i * q_half * qn, pu, pv, pn, p_half
            start, direction, limit, start_2, direction_2, limit_2 = mu + su, du, u_half, mv + sv, dv, v_half
            if side >= 2:
                start, direction, limit, start_2, direction_2, limit_2 = mv + sv, dv, v_half, mu + su, du, u_half
            if abs(direction) > 1e-9:
                t = (j * limit - start) / direction
                cu, cv, gap = mu + su + t * du, mv + sv + t * dv, mn + sn + t * dn
                shared = abs(t) < reach and abs(start_2 + t * direction_2) < limit_2
        if shared and gap < margin:
            place = centre + u * cu + v * cv + out * (0.5 * gap)
            count = add(first, count, FEW, size, place, sign * out, gap, 0.0, found)
    return count
