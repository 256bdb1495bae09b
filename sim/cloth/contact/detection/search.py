"""Where moving surfaces come near each other."""

from typing import Any

from sim.cloth.contact.detection.ccd import approach
from sim.cloth.contact.detection.proximity import nearest
from sim.cloth.fabric.layout import Weights
from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Vectors, vec3
from sim.neighbors.box_tree import meet, next_node

POINT, EDGE, PLANE = range(3)
"""Kinds of pairs; planes are numbered from PLANE on."""

Hits: Any = argpack(
    corner=Integers,
    weight=Weights,
    toward=Vectors,
    narrow=Integers,
    hit_count=Integers,
)
"""Pairs that come near: four points, their weights then, and the unit vector to the first primitive; and whether they
come nearer than they may at all. How many there are of each query."""

TreeBoxes: Any = argpack(leaves=ti.i32, primitives=ti.i32, member=Integers, low=Vectors, high=Vectors)
"""A tree of boxes around so many primitives, in so many leaves: points of each primitive, and the corners of the boxes
of nodes [m]."""

SweptPoints: Any = argpack(half=Numbers, start=Vectors, end=Vectors, rest=Vectors)
"""Half the thickness at points [m], where they are before and after a step, and where they were placed [m]."""


@ti.kernel
def find_near(
    edges: ti.template(),
    itself: ti.i32,
    crowded: ti.i32,
    queries: ti.i32,
    room: ti.i32,
    early: ti.f64,
    least: ti.f64,
    at_rest: ti.f64,
    query: Integers,
    tree: TreeBoxes,
    points: SweptPoints,
    hits: Hits,
):
    """For each point, or edge, the triangles, or edges, of a tree that come nearer than `early` of the thickness on the
    way of points, at most `room` of them; `least`: share of the thickness, and of the distance at the start, that has
    to be kept. `itself`: queries are the leaves of the tree, and each looks only at those after it. `crowded`: pairs
    are no thicker than the share `at_rest` of their distance at rest."""
    for k in range(queries):
        i, j = 0, 0
        if ti.static(edges):
            i, j = query[2 * k], query[2 * k + 1]
        else:
            i, j = query[k], query[k]
        lower = ti.min(ti.min(points.start[i], points.end[i]), ti.min(points.start[j], points.end[j])) - points.half[i]
        upper = ti.max(ti.max(points.start[i], points.end[i]), ti.max(points.start[j], points.end[j])) + points.half[i]
        count, node = 0, ti.select(tree.primitives > 0, 1, 0)
        if itself == 1 and node > 0:
            node = next_node(tree.leaves + k)
        while node > 0:
            inside = meet(lower, upper, tree.low[node], tree.high[node])
            if inside and node < tree.leaves:
                node = 2 * node
            else:
                if inside:
                    t = node - tree.leaves
                    a, b, c, d = i, j, 0, 0
                    disjoint = 1
                    if ti.static(edges):
                        c, d = tree.member[2 * t], tree.member[2 * t + 1]
                        disjoint = int(i != c and i != d and j != c and j != d)
                        if itself == 1 and c < i:
                            a, b, c, d = c, d, i, j
                    else:
                        b, c, d = tree.member[3 * t], tree.member[3 * t + 1], tree.member[3 * t + 2]
                        disjoint = int(i != b and i != c and i != d)
                    if disjoint:
                        thickness = points.half[a] + points.half[c]
                        if crowded == 1:
                            apart = nearest(
                                edges, points.rest[a], points.rest[b], points.rest[c], points.rest[d]
                            ).apart.norm()
                            thickness = ti.min(thickness, at_rest * apart)
                        pa, pb, pc, pd = points.start[a], points.start[b], points.start[c], points.start[d]
                        da, db, dc, dd = points.end[a] - pa, points.end[b] - pb, points.end[c] - pc, points.end[d] - pd
                        met = approach(edges, pa, pb, pc, pd, da, db, dc, dd, thickness, early, least)
                        if met.time <= 1.0:
                            if count < room:
                                slot = k * room + count
                                hits.corner[4 * slot] = a
                                hits.corner[4 * slot + 1] = b
                                hits.corner[4 * slot + 2] = c
                                hits.corner[4 * slot + 3] = d
                                hits.weight[slot] = met.weight
                                hits.toward[slot] = met.apart / ti.max(met.apart.norm(), 1e-30)
                                hits.narrow[slot] = met.narrow
                            count += 1
                node = next_node(node)
        hits.hit_count[k] = count


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
