"""Where moving surfaces come near each other."""

from typing import Any

from sim.cloth.contact.detection.ccd import Approach, approach
from sim.cloth.contact.detection.proximity import nearest
from sim.cloth.fabric.layout import Weights
from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Vectors, vec3
from sim.neighbors.box_tree import GROUP, BoxTree, holds, next_node, of_primitive, seen_from

POINT, EDGE, PLANE = range(3)
"""Kinds of pairs; planes are numbered from PLANE on."""
LEAST = 0.25
"""This share of the thickness, or of the distance at the start where that is less, is kept in any case."""
AT_REST = 0.5
"""Of the distance at rest, where pairs are crowded, is the most that they are thick."""

Hits: Any = argpack(
    corner=Integers,
    weight=Weights,
    toward=Vectors,
    narrow=Integers,
    hit_count=Integers,
)
"""Pairs that come near: four points, their weights then, and the unit vector to the first primitive; and whether they
come nearer than they may at all. How many there are of each query."""

SweptPoints: Any = argpack(half=Numbers, start=Vectors, end=Vectors, rest=Vectors)
"""Half the thickness at points [m], where they are before and after a step, and where they were placed [m]."""


@ti.kernel
def find_near(
    edges: ti.template(),
    itself: ti.i32,
    crowded: ti.i32,
    room: ti.i32,
    early: ti.f64,
    query: BoxTree,
    tree: BoxTree,
    points: SweptPoints,
    hits: Hits,
):
    """For each point, or edge, of a tree the triangles, or edges, of another that come nearer than `early` of the
    thickness on the way of points, at most `room` of them. `itself`: both are the same tree, and each edge looks only
    at those after it. `crowded`: pairs are no thicker than AT_REST of their distance at rest."""
    for group in range((query.primitives + GROUP - 1) // GROUP):
        for k in range(GROUP * group, GROUP * (group + 1)):
            hits.hit_count[k] = 0
        leaf, node = query.leaves + group, ti.select(tree.primitives > 0, 1, 0)
        low, high = query.low[leaf], query.high[leaf]
        drift_low, drift_high = query.drift_low[leaf], query.drift_high[leaf]
        if itself == 1:
            node = leaf
        while node > 0:
            lower, upper = seen_from(low, high, drift_low, drift_high, tree, node)
            inside = holds(tree, node, lower, upper)
            if inside and node < tree.leaves:
                node = 2 * node
            else:
                if inside:
                    first = GROUP * (node - tree.leaves)
                    for k in range(GROUP * group, ti.min(GROUP * (group + 1), query.primitives)):
                        lower, upper = _swept(k, query, tree, node)
                        begin = ti.select(itself == 1, ti.max(first, k + 1), first)
                        end = ti.select(holds(tree, node, lower, upper), first + GROUP, begin)
                        for t in range(begin, end):
                            if holds(tree, of_primitive(t, tree), lower, upper):
                                _compare(edges, itself, crowded, room, early, k, t, query, tree, points, hits)
                node = next_node(node)


@ti.func
def _swept(k: ti.i32, query: ti.template(), tree: ti.template(), node: ti.i32):
    """The box of a query as seen from what is in a node."""
    i = of_primitive(k, query)
    return seen_from(query.low[i], query.high[i], query.drift_low[i], query.drift_high[i], tree, node)


@ti.func
def _compare(
    edges: ti.template(),
    itself: ti.i32,
    crowded: ti.i32,
    room: ti.i32,
    early: ti.f64,
    k: ti.i32,
    t: ti.i32,
    query: ti.template(),
    tree: ti.template(),
    points: ti.template(),
    hits: ti.template(),
):
    """Keep a pair of primitives that come near, unless they share a point."""
    a, b, c, d = 0, 0, 0, 0
    disjoint = 0
    if ti.static(edges):
        a, b, c, d = query.member[2 * k], query.member[2 * k + 1], tree.member[2 * t], tree.member[2 * t + 1]
        disjoint = int(a != c and a != d and b != c and b != d)
        if itself == 1 and c < a:
            a, b, c, d = c, d, a, b
    else:
        a, b, c, d = query.member[k], tree.member[3 * t], tree.member[3 * t + 1], tree.member[3 * t + 2]
        disjoint = int(a != b and a != c and a != d)
    if disjoint:
        pa, pb, pc, pd = points.start[a], points.start[b], points.start[c], points.start[d]
        da, db, dc, dd = points.end[a] - pa, points.end[b] - pb, points.end[c] - pc, points.end[d] - pd
        met, known, thickness = Approach(time=0.0), 1 - crowded, points.half[a] + points.half[c]
        # Most pairs are too far apart for any thickness.
        for _look in range(2):
            met = approach(edges, pa, pb, pc, pd, da, db, dc, dd, thickness, early, LEAST)
            if known == 1 or met.time > 1.0:
                break
            apart = nearest(edges, points.rest[a], points.rest[b], points.rest[c], points.rest[d]).apart.norm()
            thickness = ti.min(thickness, AT_REST * apart)
            known = 1
        if met.time <= 1.0:
            count = hits.hit_count[k]
            if count < room:
                slot = k * room + count
                hits.corner[4 * slot] = a
                hits.corner[4 * slot + 1] = b
                hits.corner[4 * slot + 2] = c
                hits.corner[4 * slot + 3] = d
                hits.weight[slot] = met.weight
                hits.toward[slot] = met.apart / ti.max(met.apart.norm(), 1e-30)
                hits.narrow[slot] = met.narrow
            hits.hit_count[k] = count + 1


@ti.kernel
def find_near_plane(
    queries: ti.i32,
    early: ti.f64,
    normal: vec3,
    offset: ti.f64,
    query: Integers,
    half: Numbers,
    place: Vectors,
    number: Integers,
):
    """Which points come nearer to a plane than `early` of half their thickness."""
    for k in range(queries):
        i = query[k]
        number[k] = int(normal.dot(place[i]) - offset < early * half[i])


@ti.kernel
def gather(
    queries: ti.i32,
    room: ti.i32,
    first: Integers,
    hits: Hits,
    corner_out: ti.types.ndarray(dtype=ti.i32, ndim=2),
    weight_out: ti.types.ndarray(dtype=ti.f64, ndim=2),
    normal_out: ti.types.ndarray(dtype=ti.f64, ndim=2),
    narrow_out: Integers,
):
    """Hits one after the other."""
    for k in range(queries):
        for n in range(hits.hit_count[k]):
            slot, row = k * room + n, first[k] + n
            for corner in ti.static(range(4)):
                corner_out[row, corner] = hits.corner[4 * slot + corner]
                weight_out[row, corner] = hits.weight[slot][corner]
            for axis in ti.static(range(3)):
                normal_out[row, axis] = hits.toward[slot][axis]
            narrow_out[row] = hits.narrow[slot]


@ti.kernel
def look_again(
    count: ti.i32,
    key: ti.types.ndarray(dtype=ti.i32, ndim=2),
    place: Vectors,
    apart_out: Numbers,
    normal_out: ti.types.ndarray(dtype=ti.f64, ndim=2),
    weight_out: ti.types.ndarray(dtype=ti.f64, ndim=2),
):
    """Distance [m], normal and weights of pairs, each a kind and four points."""
    for k in range(count):
        p, q, r, s = place[key[k, 1]], place[key[k, 2]], place[key[k, 3]], place[key[k, 4]]
        found = nearest(False, p, q, r, s)
        if key[k, 0] == EDGE:
            found = nearest(True, p, q, r, s)
        distance = found.apart.norm()
        apart_out[k] = distance
        for axis in ti.static(range(3)):
            normal_out[k, axis] = found.apart[axis] / ti.max(distance, 1e-30)
        for corner in ti.static(range(4)):
            weight_out[k, corner] = found.weight[corner]
