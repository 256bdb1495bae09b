"""The ways of particles past moving triangles."""

from typing import Any

from sim.cloth.contact.detection.ccd import Approach, approach
from sim.cloth.contact.detection.proximity import point_triangle
from sim.device.argument_packs import argpack
from sim.device.arrays import Vec4Array, real
from sim.device.compiler import ti
from sim.device.double import Integers, Vectors, vec3
from sim.neighbors.box_tree import GROUP, BoxTree, holds, next_node, of_primitive, seen_from

ROUNDS = 8
"""Of looking, after a particle has been moved, for what it would meet there."""
NEARER = 0.5
"""Of the distance that a particle has from a triangle at the start of a step, this share is kept."""

Hits: Any = argpack(struck=Integers, weight=Vectors)
"""The triangle that each particle has struck, and the barycentric weights of the place."""


@ti.func
def _beside(
    x: vec3, moved: vec3, a: vec3, b: vec3, c: vec3, da: vec3, db: vec3, dc: vec3, met: Approach, gap: ti.f64
) -> vec3:
    """Where a particle from x, that would be at `moved`, may be after the step beside a triangle that moves: on its
    side, `gap` [m] off; or, where it is not above the triangle, carried with what is nearest of it."""
    weight = -vec3(met.start_weight[1], met.start_weight[2], met.start_weight[3])
    side = ti.cast(1.0, ti.f64)
    if met.start_apart.dot((b - a).cross(c - a)) < 0.0:
        side = -side
    p, q, r = a + da, b + db, c + dc
    normal = side * (q - p).cross(r - p).normalized()
    found = moved + ti.max(gap - normal.dot(moved - p), 0.0) * normal
    at_end = point_triangle(found, p, q, r)
    inside = at_end.weight[1] < 0.0 and at_end.weight[2] < 0.0 and at_end.weight[3] < 0.0
    if not inside:
        found = x + weight[0] * da + weight[1] * db + weight[2] * dc
    return found


@ti.func
def _may_meet(before: vec3, after: vec3, gap: ti.f64, triangles: ti.template(), node: ti.i32) -> ti.i32:
    """Whether a particle on its way may come near to what is in a node."""
    drift = after - before
    lower, upper = seen_from(before - gap, before + gap, drift, drift, triangles, node)
    return holds(triangles, node, lower, upper)


@ti.kernel
def keep(
    count: ti.i32,
    dt: real,
    gap: ti.f64,
    origin: vec3,
    triangles: BoxTree,
    start: Vectors,
    place: Vectors,
    position: Vec4Array,
    velocity: Vec4Array,
    hits: Hits,
) -> ti.types.vector(2, ti.i32):
    """Move particles that would come nearer than `gap` [m] to a triangle; `hits` has the last one of each, -1 where
    there is none. Returns how many were moved, and how many would come too near wherever they are moved."""
    moved_particles, through = 0, 0
    for i in range(count):
        after = ti.cast(position[i].xyz, ti.f64) + origin
        before = after - ti.cast(dt * velocity[i].xyz, ti.f64)
        hit, again, rounds = -1, 1, 0
        weight = vec3(0.0, 0.0, 0.0)
        while again == 1 and rounds < ROUNDS:
            again = 0
            rounds += 1
            node = ti.select(triangles.primitives > 0, 1, 0)
            while node > 0:
                inside = _may_meet(before, after, gap, triangles, node)
                if inside and node < triangles.leaves:
                    node = 2 * node
                else:
                    first = GROUP * (node - triangles.leaves)
                    for t in range(first, ti.select(inside == 1, first + GROUP, first)):
                        if _may_meet(before, after, gap, triangles, of_primitive(t, triangles)):
                            j, k, m = triangles.member[3 * t], triangles.member[3 * t + 1], triangles.member[3 * t + 2]
                            a, b, c = start[j], start[k], start[m]
                            da, db, dc = place[j] - a, place[k] - b, place[m] - c
                            met = approach(False, before, a, b, c, after - before, da, db, dc, gap, 1.0, NEARER)
                            if met.narrow == 1:
                                hit = t
                                again = 1
                                after = _beside(before, after, a, b, c, da, db, dc, met, gap)
                                nearest = point_triangle(after, a + da, b + db, c + dc)
                                weight = -vec3(nearest.weight[1], nearest.weight[2], nearest.weight[3])
                    node = next_node(node)
        hits.struck[i] = hit
        if hit >= 0:
            moved_particles += 1
            hits.weight[i] = weight
            position[i].xyz = ti.cast(after - origin, real)
            through += again
    return ti.Vector([moved_particles, through])
