"""What `sim.fluid.boundary.faces` does on the device."""

import taichi as ti

from sim.device.arrays import DoubleTable, IntArray, IntTable, RealArray, Vec4Array, real, vec2, vec3, vec4
from sim.fluid.boundary.gaps import (
    INCLINED,
    denser,
    facing,
    lacking,
    led,
    most_lacking,
    relieved,
    slack_after,
    wide,
)
from sim.fluid.boundary.half_space import along_faces, face_slope, left_of, own_share
from sim.fluid.boundary.look import FAR, half_space, half_spaces, look, surface_velocity, to_own, to_world
from sim.fluid.packed import DENSITY, DISTANCE
from sim.geometry.distance.narrow_band import OPPOSITE
from sim.geometry.distance.sdf import GRID, PLANE
from sim.neighbors.spatial_hash import padded

GROUP = 32
"""Points in a row for which solids are sought together."""
SUDDEN = 0.05
"""Share of the rest density that half-spaces which come into sight may add at once."""
TOUCHING = 1e-3
"""Share of the line of a pair by which it may seem to leave a sheet before it enters it, by rounding."""
FACING = -0.3
"""Cosine of the angle between the normals of two particles beyond which a solid may lie between them."""


@ti.kernel
def count(
    count: ti.i32,
    groups: ti.i32,
    reach: ti.f64,
    position: Vec4Array,
    solids: ti.i32,
    kind: IntArray,
    boxes: DoubleTable,
    pose: DoubleTable,
    first: IntArray,
) -> ti.i32:
    """Write to `first` where the members of each group will begin, and after the last where they end, which is
    returned: solids that may come near its box."""
    for g in range(groups):
        low, high = _box(g, count, position)
        found = 0
        for s in range(solids):
            if _comes_near(s, low, high, reach, kind, boxes, pose):
                found += fronts_of(kind[s])
        first[g + 1] = found
    ti.loop_config(serialize=True)
    for _ in range(1):
        total = 0
        for g in range(groups):
            first[g] = total
            total += first[g + 1]
        first[groups] = total
    return first[groups]


@ti.func
def _box(g: ti.i32, count: ti.i32, position: Vec4Array):
    low, high = vec3(1e30), vec3(-1e30)
    for i in range(g * GROUP, ti.min((g + 1) * GROUP, count)):
        low, high = ti.min(low, position[i].xyz), ti.max(high, position[i].xyz)
    return low, high


@ti.func
def _comes_near(s: ti.i32, low: vec3, high: vec3, reach: ti.f64, kind: IntArray, boxes: DoubleTable, pose: DoubleTable):
    near = _beside(s, low, high, reach, boxes)
    if kind[s] == PLANE:
        least = ti.cast(0.0, ti.f64)
        for axis in ti.static(range(3)):
            n = pose[s, 3 * axis + 1]
            corner = ti.cast(ti.select(n > 0.0, low[axis], high[axis]), ti.f64)
            least += n * (corner - pose[s, 9 + axis])
        near = least < reach
    return near


@ti.func
def fronts_of(kind: ti.i32) -> ti.i32:
    """Half-spaces that a solid of this kind may be to one particle."""
    return ti.select(kind == GRID, 3, 1)


@ti.func
def _beside(s: ti.i32, low: vec3, high: vec3, reach: ti.f64, boxes: DoubleTable):
    beside = True
    for axis in ti.static(range(3)):
        beside = beside and ti.cast(low[axis], ti.f64) < boxes[s, 3 + axis] + reach
        beside = beside and ti.cast(high[axis], ti.f64) > boxes[s, axis] - reach
    return beside


@ti.kernel
def find(
    count: ti.i32,
    groups: ti.i32,
    reach: ti.f64,
    position: Vec4Array,
    solids: ti.i32,
    boxes: DoubleTable,
    first: IntArray,
    member: IntArray,
    has_own: ti.i32,
    own: IntArray,
    pose: DoubleTable,
    kind: IntArray,
    half: Vec4Array,
    shift: vec2,
    kinds: ti.template(),
    frame: DoubleTable,
    lattice: IntTable,
    table: IntArray,
    nodes: Vec4Array,
    begin: IntArray,
    size: IntArray,
    solid: IntArray,
    particle: IntArray,
    near: Vec4Array,
):
    """Write to `member` the solids that may come near each group, and the entries of each particle: where they begin
    and how many there are, and of each its solid, its particle, and the half-space within `reach` [m], in the solid's
    own frame."""
    for g in range(groups):
        low, high = _box(g, count, position)
        slot = first[g]
        for s in range(solids):
            if _comes_near(s, low, high, reach, kind, boxes, pose):
                for k in range(fronts_of(kind[s])):
                    member[slot + k] = s if k == 0 else -1
                slot += fronts_of(kind[s])
    for i in range(count):
        g = i // GROUP
        room = first[g + 1] - first[g]
        start = GROUP * first[g] + (i - GROUP * g) * room
        x = position[i].xyz
        found = 0
        for k in range(room):
            s = member[first[g] + k]
            wanted = s >= 0
            if has_own == 1:
                wanted = wanted and own[i] != s
            if wanted:
                wanted = _beside(s, x, x, reach, boxes)
            if wanted:
                p = to_own(s, x, pose)
                one, second, third = half_spaces(
                    s, p, ti.cast(reach, real), kind, half, shift, kinds, frame, lattice, table, nodes
                )
                for c in range(3):
                    front = one if c == 0 else (second if c == 1 else third)
                    if front.xyz.dot(ti.cast(p, real)) - front.w < reach and front.w < FAR:
                        e = start + found
                        solid[e] = s
                        particle[e] = i
                        near[e] = front
                        found += 1
        begin[i] = start
        size[i] = found


@ti.kernel
def place(
    count: ti.i32,
    ahead: real,
    inverse_h: real,
    spacing: real,
    fit: vec4,
    position: Vec4Array,
    velocity: Vec4Array,
    has_slack: ti.i32,
    slack: RealArray,
    eased: RealArray,
    since: real,
    fall: real,
    rest_density: real,
    pose: DoubleTable,
    kind: IntArray,
    half: Vec4Array,
    shift: vec2,
    kinds: ti.template(),
    frame: DoubleTable,
    lattice: IntTable,
    table: IntArray,
    nodes: Vec4Array,
    bend: RealArray,
    firm: IntArray,
    holds: IntArray,
    slim: IntArray,
    has_pull: ti.i32,
    begin: IntArray,
    size: IntArray,
    solid: IntArray,
    near: Vec4Array,
    face: Vec4Array,
    weight: RealArray,
    held: RealArray,
    pull: Vec4Array,
    share: Vec4Array,
    excess: RealArray,
):
    """Of two that face the same way the nearer one counts: a seam between them is no edge. Those at right angles count
    both, and so does one behind the other, as far as they do.

    Fluid in gaps narrower than a layer has slack (`sim.fluid.boundary.gaps`), and what has come into sight is `eased`;
    both are brought on by the time `since` they were last [s], unless that is less than none; fall: g d [m^2/s^2].
    """
    for i in range(count):
        first, last = begin[i], begin[i] + size[i]
        total, void = ti.cast(0.0, real), ti.cast(1.0, real)
        gradient, loose, ease = vec3(0.0), ti.cast(0.0, real), ti.cast(0.0, real)
        if last > first:
            x = position[i].xyz + ahead * velocity[i].xyz
            for e in range(first, last):
                s = solid[e]
                p = to_own(s, x, pose)
                hollow = (e > first and solid[e - 1] == s) or (e + 1 < last and solid[e + 1] == s)
                one = look(s, p, near[e], hollow, kind, half, shift, kinds, frame, lattice, table, nodes, bend)
                face[e] = vec4(to_world(s, one.xyz, pose), one.w)
            if has_slack == 1:
                loose, ease = slack[i], eased[i]
                if since >= 0.0:
                    v = velocity[i]
                    compression = relieved(v[DENSITY], rest_density, denser(loose, spacing) + ease) / rest_density - 1.0
                    loose = slack_after(loose, since, v.xyz, compression, fall)
                    ease = slack_after(ease * spacing, since, v.xyz, compression, fall) / spacing
                loose = ti.max(loose, most_lacking(first, last, solid, face, spacing))
                if since > 0.0 and loose > 0.0:
                    velocity[i].xyz = led(
                        velocity[i].xyz, x, since, fall, loose, first, last, solid, face, pose, spacing
                    )
            for e in range(first, last):
                open_gap, off = ti.cast(1.0, real), ti.max(ti.min(loose, 0.5 * spacing - face[e][DISTANCE]), 0.0)
                for other in range(first, last):
                    if solid[other] != solid[e] and facing(face[e].xyz, face[other].xyz):
                        open_gap = ti.min(
                            open_gap, wide(face[e][DISTANCE] + face[other][DISTANCE], spacing, slim[solid[e]])
                        )
                        off = ti.max(off, lacking(face[e], face[other], INCLINED, spacing))
                weight[e] = off
                if has_pull == 1:
                    pull[e].w = ti.select(firm[solid[e]] == 1, 1.0, open_gap)
            for e in range(first, last):
                face[e][DISTANCE] += weight[e]
            for e in range(first, last):
                counts = ti.cast(1.0, real)
                for other in range(first, last):
                    nearer = face[other][DISTANCE] < face[e][DISTANCE] or (
                        face[other][DISTANCE] == face[e][DISTANCE] and other < e
                    )
                    if nearer:
                        like = ti.max(face[e].xyz.dot(face[other].xyz), 0.0)
                        counts *= (1.0 - like * like) ** 2
                weight[e] = counts
                held[e] = counts * holds[solid[e]] * pull[e].w
                share_of = counts * own_share(face[e][DISTANCE], fit, inverse_h)
                left = left_of(share_of, fit)
                total += share_of - (1.0 - left)
                void *= left
            total += 1.0 - void
            for e in range(first, last):
                one = face_slope(face[e][DISTANCE], weight[e], void, fit, inverse_h) * face[e].xyz
                if has_pull == 1:
                    pull[e].xyz = pull[e].w * along_faces(i, one, begin, size, face, held, fit, inverse_h)
                gradient += one
        if since >= 0.0:
            slack[i], eased[i] = loose, ease
        share[i] = vec4(gradient, total)
        excess[i] = denser(loose, spacing) + ease


@ti.kernel
def note(count: ti.i32, share: Vec4Array, known: RealArray):
    """Remember what solids add, with one more than that: where nothing is known there is none."""
    for i in range(count):
        known[i] = 1.0 + share[i].w


@ti.kernel
def ease(count: ti.i32, known: RealArray, share: Vec4Array, eased: RealArray, excess: RealArray):
    """Let what solids add by other half-spaces than before, at the same place, not press yet."""
    for i in range(count):
        sudden = share[i].w - (known[i] - 1.0)
        if known[i] > 0.0 and ti.abs(sudden) > SUDDEN:
            left = ti.math.clamp(eased[i] + sudden, 0.0, share[i].w)
            excess[i] += left - eased[i]
            eased[i] = left


@ti.kernel
def sever(
    count: ti.i32,
    position: Vec4Array,
    begin: IntArray,
    size: IntArray,
    solid: IntArray,
    face: Vec4Array,
    near_size: IntArray,
    near_index: IntTable,
):
    """A pair is cut where its line enters the solid through one particle's half-space before it leaves it through the
    other's, and these face away from each other."""
    for i in range(count):
        if size[i] > 0:
            x = position[i].xyz
            left = 0
            for k in range(near_size[i]):
                j = near_index[i, k]
                d = position[j].xyz - x
                cut = False
                for e in range(begin[i], begin[i] + size[i]):
                    mine = face[e]
                    beyond = mine.w + mine.xyz.dot(d)
                    if beyond < 0.0 and mine.w >= 0.0:
                        for o in range(begin[j], begin[j] + size[j]):
                            other = face[o]
                            if solid[o] == solid[e] and mine.xyz.dot(other.xyz) < FACING:
                                behind = other.w - other.xyz.dot(d)
                                if behind < 0.0 and other.w >= 0.0:
                                    enters = mine.w / (mine.w - beyond)
                                    leaves = 1.0 - other.w / (other.w - behind)
                                    cut = cut or enters <= leaves + TOUCHING
                if not cut:
                    near_index[i, left] = j
                    left += 1
            near_size[i] = left
            for k in range(left, padded(left)):
                near_index[i, k] = i


@ti.kernel
def prevent_penetration(
    count: ti.i32,
    gap: real,
    position: Vec4Array,
    velocity: Vec4Array,
    pose: DoubleTable,
    kind: IntArray,
    half: Vec4Array,
    shift: vec2,
    kinds: ti.template(),
    frame: DoubleTable,
    lattice: IntTable,
    table: IntArray,
    nodes: Vec4Array,
    begin: IntArray,
    size: IntArray,
    solid: IntArray,
    near: Vec4Array,
) -> ti.i32:
    """Take particles that came out on the other side of a solid back to `gap` [m] before the side that was `near`,
    without the velocity into it; returns how many entries that concerned."""
    held = 0
    for i in range(count):
        for e in range(begin[i], begin[i] + size[i]):
            s = solid[e]
            x = position[i].xyz
            p = to_own(s, x, pose)
            at = ti.cast(p, real)
            side = near[e]
            if side.xyz.dot(at) - side.w < 0.0 and kind[s] != PLANE:
                one = half_space(s, p, kind, half, shift, kinds, frame, lattice, table, nodes)
                if one.w < FAR and one.xyz.dot(side.xyz) < OPPOSITE:
                    normal = to_world(s, side.xyz, pose)
                    position[i].xyz = x + (gap + side.w - side.xyz.dot(at)) * normal
                    relative = velocity[i].xyz - surface_velocity(s, x, pose)
                    velocity[i].xyz -= ti.min(normal.dot(relative), 0.0) * normal
                    ti.atomic_add(held, 1)
    return held
