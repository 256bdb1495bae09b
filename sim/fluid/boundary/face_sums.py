"""What `sim.fluid.boundary.faces` does on the device."""

from sim.device.arrays import RealArray, Vec4Array, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.gaps import (
    INCLINED,
    allowed_excess,
    facing,
    missing_room,
    most_missing_room,
    openness,
    pressing_density,
    slack_after,
    steered,
)
from sim.fluid.boundary.half_space import along_faces, face_slope, left_of, own_share
from sim.fluid.boundary.half_spaces.nearest import FAR, half_space, nearest_half_space
from sim.fluid.boundary.half_spaces.pose import surface_velocity, to_local, to_world
from sim.fluid.layout import DENSITY, DISTANCE, Points, Solids, Walls
from sim.geometry.distance.narrow_band import OPPOSITE
from sim.geometry.distance.sdf import PLANE
from sim.neighbors.spatial_hash import Neighbors, padded

SUDDEN = 0.05
"""Share of the rest density that half-spaces which come into sight may add at once."""
TOUCHING = 1e-3
"""Share of the line of a pair by which it may seem to leave a sheet before it enters it, by rounding."""
FACING = -0.3
"""Cosine of the angle between the normals of two particles beyond which a solid may lie between them."""


@ti.kernel
def place(
    kinds: ti.template(),
    has_slack: ti.i32,
    has_pull: ti.i32,
    count: ti.i32,
    ahead: real,
    inverse_h: real,
    rest_density: real,
    since: real,
    fall: real,
    points: Points,
    solids: Solids,
    walls: Walls,
):
    """Of two that face the same way the nearer one counts: a seam between them is no edge. Those at right angles count
    both, and so does one behind the other, as far as they do.

    Fluid in gaps narrower than a layer has slack (`sim.fluid.boundary.gaps`), and what has come into sight is `eased`;
    both are brought on by the time `since` they were last [s], unless that is less than none; fall: g d [m^2/s^2].
    """
    for i in range(count):
        spacing = walls.spacing
        first, last = walls.begin[i], walls.begin[i] + walls.size[i]
        total, void = ti.cast(0.0, real), ti.cast(1.0, real)
        gradient, loose, ease = vec3(0.0), ti.cast(0.0, real), ti.cast(0.0, real)
        if last > first:
            x = points.position[i].xyz + ahead * points.velocity[i].xyz
            for e in range(first, last):
                s = walls.solid[e]
                p = to_local(s, x, solids.pose)
                hollow = (e > first and walls.solid[e - 1] == s) or (e + 1 < last and walls.solid[e + 1] == s)
                one = nearest_half_space(s, p, walls.near[e], hollow, kinds, solids)
                walls.face[e] = vec4(to_world(s, one.xyz, solids.pose), one.w)
            if has_slack == 1:
                loose, ease = points.slack[i], points.eased[i]
                if since >= 0.0:
                    v = points.velocity[i]
                    excess = allowed_excess(loose, spacing) + ease
                    compression = pressing_density(v[DENSITY], rest_density, excess) / rest_density - 1.0
                    loose = slack_after(loose, since, v.xyz, compression, fall)
                    ease = slack_after(ease * spacing, since, v.xyz, compression, fall) / spacing
                loose = ti.max(loose, most_missing_room(first, last, walls))
                if since > 0.0 and loose > 0.0:
                    points.velocity[i].xyz = steered(points.velocity[i].xyz, x, since, fall, loose, first, last, walls)
            for e in range(first, last):
                open_gap, off = ti.cast(1.0, real), ti.max(ti.min(loose, 0.5 * spacing - walls.face[e][DISTANCE]), 0.0)
                for other in range(first, last):
                    if walls.solid[other] != walls.solid[e] and facing(walls.face[e].xyz, walls.face[other].xyz):
                        gap = walls.face[e][DISTANCE] + walls.face[other][DISTANCE]
                        open_gap = ti.min(open_gap, openness(gap, spacing, solids.slim[walls.solid[e]]))
                        off = ti.max(off, missing_room(walls.face[e], walls.face[other], INCLINED, spacing))
                walls.weight[e] = off
                if has_pull == 1:
                    walls.pull[e].w = ti.select(solids.firm[walls.solid[e]] == 1, 1.0, open_gap)
            for e in range(first, last):
                walls.face[e][DISTANCE] += walls.weight[e]
            for e in range(first, last):
                counts = ti.cast(1.0, real)
                for other in range(first, last):
                    nearer = walls.face[other][DISTANCE] < walls.face[e][DISTANCE] or (
                        walls.face[other][DISTANCE] == walls.face[e][DISTANCE] and other < e
                    )
                    if nearer:
                        like = ti.max(walls.face[e].xyz.dot(walls.face[other].xyz), 0.0)
                        counts *= (1.0 - like * like) ** 2
                walls.weight[e] = counts
                walls.held[e] = counts * solids.holds[walls.solid[e]] * walls.pull[e].w
                share_of = counts * own_share(walls.face[e][DISTANCE], walls.fit, inverse_h)
                left = left_of(share_of, walls.fit)
                total += share_of - (1.0 - left)
                void *= left
            total += 1.0 - void
            for e in range(first, last):
                face = walls.face[e]
                one = face_slope(face[DISTANCE], walls.weight[e], void, walls.fit, inverse_h) * face.xyz
                if has_pull == 1:
                    walls.pull[e].xyz = walls.pull[e].w * along_faces(i, one, walls, inverse_h)
                gradient += one
        if since >= 0.0:
            points.slack[i], points.eased[i] = loose, ease
        walls.share[i] = vec4(gradient, total)
        walls.excess[i] = allowed_excess(loose, spacing) + ease


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
def sever(count: ti.i32, position: Vec4Array, walls: Walls, near: Neighbors):
    """A pair is cut where its line enters the solid through one particle's half-space before it leaves it through the
    other's, and these face away from each other."""
    for i in range(count):
        if walls.size[i] > 0:
            x = position[i].xyz
            left = 0
            for k in range(near.size[i]):
                j = near.index[near.begin[i] + k]
                d = position[j].xyz - x
                cut = False
                for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
                    mine = walls.face[e]
                    beyond = mine.w + mine.xyz.dot(d)
                    if beyond < 0.0 and mine.w >= 0.0:
                        for o in range(walls.begin[j], walls.begin[j] + walls.size[j]):
                            other = walls.face[o]
                            if walls.solid[o] == walls.solid[e] and mine.xyz.dot(other.xyz) < FACING:
                                behind = other.w - other.xyz.dot(d)
                                if behind < 0.0 and other.w >= 0.0:
                                    enters = mine.w / (mine.w - beyond)
                                    leaves = 1.0 - other.w / (other.w - behind)
                                    cut = cut or enters <= leaves + TOUCHING
                if not cut:
                    near.index[near.begin[i] + left] = j
                    left += 1
            near.size[i] = left
            for k in range(left, padded(left)):
                near.index[near.begin[i] + k] = i


@ti.kernel
def prevent_penetration(
    kinds: ti.template(),
    count: ti.i32,
    gap: real,
    position: Vec4Array,
    velocity: Vec4Array,
    solids: Solids,
    walls: Walls,
) -> ti.i32:
    """Take particles that came out on the other side of a solid back to `gap` [m] before the side that was `near`,
    without the velocity into it; returns how many entries that concerned."""
    held = 0
    for i in range(count):
        for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
            s = walls.solid[e]
            x = position[i].xyz
            p = to_local(s, x, solids.pose)
            at = ti.cast(p, real)
            side = walls.near[e]
            if side.xyz.dot(at) - side.w < 0.0 and solids.kind[s] != PLANE:
                one = half_space(s, p, kinds, solids)
                if one.w < FAR and one.xyz.dot(side.xyz) < OPPOSITE:
                    normal = to_world(s, side.xyz, solids.pose)
                    position[i].xyz = x + (gap + side.w - side.xyz.dot(at)) * normal
                    relative = velocity[i].xyz - surface_velocity(s, x, solids.pose)
                    velocity[i].xyz -= ti.min(normal.dot(relative), 0.0) * normal
                    ti.atomic_add(held, 1)
    return held
