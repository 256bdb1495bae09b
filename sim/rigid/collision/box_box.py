"""Contacts of two boxes: the axis that separates them most, then the corners of the area where they meet.

Separating axes: Gottschalk et al. 1996.
"""

import taichi as ti

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


@ti.func
def box_box(
    first: ti.i32,
    x_a: vec3,
    turn_a: mat3,
    half_a: vec3,
    x_b: vec3,
    turn_b: mat3,
    half_b: vec3,
    margin: ti.f64,
    found: ti.template(),
) -> ti.i32:
    """Write contacts with a gap below `margin` [m] from index `first` on; returns their number, or -1 where the boxes
    are farther apart.

    Normals point from b to a. None are found where a corner is nearest to a corner or an edge.
    """
    size = 2.0 * ti.min(half_a.min(), half_b.min())
    away = x_a - x_b
    best, face, owner = ti.cast(-ti.math.inf, ti.f64), 0, 0
    normal = vec3(0.0)
    for which in range(6):
        axis = _column(turn_a, which % 3)
        if which >= 3:
            axis = _column(turn_b, which % 3)
        reach = _extent(turn_a, half_a, axis) + _extent(turn_b, half_b, axis)
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
            axis = _column(turn_a, i).cross(_column(turn_b, j))
            if axis.norm_sqr() > PARALLEL:
                axis = axis.normalized()
                apart = abs(away.dot(axis)) - _extent(turn_a, half_a, axis) - _extent(turn_b, half_b, axis)
                if apart > across:
                    across, edge_a, edge_b, edges = apart, i, j, 1
                    normal = axis if away.dot(axis) >= 0.0 else -axis
    count = -1
    if edges == 1:
        if across < margin:
            count = _edges_meet(first, x_a, turn_a, half_a, x_b, turn_b, half_b, edge_a, edge_b, normal, size, found)
    elif best < margin:
        x, turn, half, x_other, turn_other, half_other, sign = x_a, turn_a, half_a, x_b, turn_b, half_b, -1.0
        if owner == 1:
            x, turn, half, x_other, turn_other, half_other, sign = x_b, turn_b, half_b, x_a, turn_a, half_a, 1.0
        count = _faces_meet(
            first, x, turn, half, x_other, turn_other, half_other, face, sign * normal, sign, margin, size, found
        )
    return count


@ti.func
def _edges_meet(
    first: ti.i32,
    x_a: vec3,
    turn_a: mat3,
    half_a: vec3,
    x_b: vec3,
    turn_b: mat3,
    half_b: vec3,
    edge_a: ti.i32,
    edge_b: ti.i32,
    normal: vec3,
    size: ti.f64,
    found: ti.template(),
) -> ti.i32:
    """Where the edge of a farthest against the normal and that of b farthest along it cross, if they do."""
    p, q = x_a, x_b
    for k in ti.static(range(3)):
        along_a, along_b = _column(turn_a, k), _column(turn_b, k)
        if k != edge_a:
            p -= along_a * half_a[k] * (1.0 if along_a.dot(normal) >= 0.0 else -1.0)
        if k != edge_b:
            q += along_b * half_b[k] * (1.0 if along_b.dot(normal) >= 0.0 else -1.0)
    u, v = _column(turn_a, edge_a), _column(turn_b, edge_b)
    d = q - p
    bend = u.dot(v)
    share = 1.0 - bend * bend
    s = (d.dot(u) - bend * d.dot(v)) / share
    t = (bend * d.dot(u) - d.dot(v)) / share
    reach_a, reach_b = half_a[edge_a], half_b[edge_b]
    count = 0
    if abs(s) <= reach_a and abs(t) <= reach_b:
        on_a, on_b = p + u * s, q + v * t
        gap = (on_a - on_b).dot(normal)
        count = add(first, 0, FEW, size, 0.5 * (on_a + on_b), normal, gap, 0.0, found)
    return count


@ti.func
def _faces_meet(
    first: ti.i32,
    x: vec3,
    turn: mat3,
    half: vec3,
    x_other: vec3,
    turn_other: mat3,
    half_other: vec3,
    face: ti.i32,
    out: vec3,
    sign: ti.f64,
    margin: ti.f64,
    size: ti.f64,
    found: ti.template(),
) -> ti.i32:
    """The corners of the area that a face with the normal `out` shares with the face of the other box against it."""
    u_axis, v_axis = (face + 1) % 3, (face + 2) % 3
    u, v = _column(turn, u_axis), _column(turn, v_axis)
    u_half, v_half = half[u_axis], half[v_axis]
    centre = x + out * half[face]
    facing, most = 0, ti.cast(-1.0, ti.f64)
    for k in range(3):
        steep = abs(_column(turn_other, k).dot(out))
        if steep > most:
            facing, most = k, steep
    against = _column(turn_other, facing)
    if against.dot(out) > 0.0:
        against = -against
    p_axis, q_axis = (facing + 1) % 3, (facing + 2) % 3
    p, q = _column(turn_other, p_axis), _column(turn_other, q_axis)
    p_half, q_half = half_other[p_axis], half_other[q_axis]
    middle = x_other + against * half_other[facing] - centre
    # Coordinates along u, v and out: of the other face's middle and of its two edges.
    mu, mv, mn = middle.dot(u), middle.dot(v), middle.dot(out)
    pu, pv, pn = p.dot(u), p.dot(v), p.dot(out)
    qu, qv, qn = q.dot(u), q.dot(v), q.dot(out)
    area = pu * qv - pv * qu
    slack = 1e-9 * size
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
                shared = abs(cu) <= u_half + slack and abs(cv) <= v_half + slack
            elif abs(area) > 1e-12:
                cu, cv = i * u_half, j * v_half
                du, dv = cu - mu, cv - mv
                s, t = (du * qv - dv * qu) / area, (dv * pu - du * pv) / area
                gap += s * pn + t * qn
                shared = abs(s) <= p_half + slack and abs(t) <= q_half + slack
        else:
            edge, side = (candidate - 8) // 4, (candidate - 8) % 4
            i = ti.cast(1 - 2 * (edge & 1), ti.f64)
            j = ti.cast(1 - 2 * (side & 1), ti.f64)
            su, sv, sn, du, dv, dn, reach = i * p_half * pu, i * p_half * pv, i * p_half * pn, qu, qv, qn, q_half
            if edge >= 2:
                su, sv, sn, du, dv, dn, reach = i * q_half * qu, i * q_half * qv, i * q_half * qn, pu, pv, pn, p_half
            start, direction, limit, other, other_direction, other_limit = mu + su, du, u_half, mv + sv, dv, v_half
            if side >= 2:
                start, direction, limit, other, other_direction, other_limit = mv + sv, dv, v_half, mu + su, du, u_half
            if abs(direction) > 1e-9:
                t = (j * limit - start) / direction
                cu, cv, gap = mu + su + t * du, mv + sv + t * dv, mn + sn + t * dn
                shared = abs(t) < reach and abs(other + t * other_direction) < other_limit
        if shared and gap < margin:
            place = centre + u * cu + v * cv + out * (0.5 * gap)
            count = add(first, count, FEW, size, place, sign * out, gap, 0.0, found)
    return count
