"""A binary tree of boxes around moving primitives, for finding those near others.

A node has two boxes: of where its primitives start, and of their displacements. Whoever asks moves, too, and asks what
comes near as seen from there: in a sheet that falls, that is only what lies beside it.

The tree is full: node k has the children 2 k and 2 k + 1. Leaves come last, and empty boxes fill them up; each holds
GROUP primitives, whose own boxes follow behind the tree: primitive k is in `of_primitive(k)`. Which primitive is in
which leaf is decided once, by where it is then (Morton 1966); boxes follow the primitives.
"""

from typing import Any

import numpy as np

from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Vectors, vec3

FAR = 1e30
GROUP = 4
"""Primitives of a leaf: to compare each with each of another leaf takes less than to go further down."""

BoxTree: Any = argpack(
    leaves=ti.i32,
    primitives=ti.i32,
    member=Integers,
    low=Vectors,
    high=Vectors,
    drift_low=Vectors,
    drift_high=Vectors,
)
"""A tree of so many leaves around so many primitives: the points of each primitive, and the corners of boxes [m], of
places at the start and of displacements. Place 0 of boxes is empty."""


def morton_order(centres: np.ndarray) -> np.ndarray:
    """An order in which primitives next to one another are near one another; `centres` [m], shape [n, 3]."""
    low, high = centres.min(axis=0), centres.max(axis=0)
    cells = ((centres - low) / max(float((high - low).max()), 1e-30) * 0x1FFFFF).astype(np.uint64)
    key = np.zeros(len(centres), np.uint64)
    for axis in range(3):
        key |= _spread(cells[:, axis]) << np.uint64(axis)
    return np.argsort(key, kind="stable")


def _spread(values: np.ndarray) -> np.ndarray:
    """Two zero bits after each of the lower 21 bits."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        values = (values | (values << np.uint64(shift))) & np.uint64(mask)
    return values


@ti.func
def next_node(node: ti.i32) -> ti.i32:
    """The node after one and all below it, in the order in which trees are searched; 0 after the last."""
    after = node + 1
    after >>= ti.math.popcnt((after & -after) - 1)
    return ti.select(after > 1, after, 0)


@ti.func
def meet(low: vec3, high: vec3, other_low: vec3, other_high: vec3) -> ti.i32:
    """Whether two boxes overlap."""
    return int((low <= other_high).all() and (other_low <= high).all())


@ti.func
def of_primitive(k: ti.i32, tree: ti.template()) -> ti.i32:
    """Where the box of a primitive is."""
    return 2 * tree.leaves + k


@ti.func
def seen_from(low: vec3, high: vec3, drift_low: vec3, drift_high: vec3, tree: ti.template(), node: ti.i32):
    """The corners of the box that another sweeps as seen from what is in a node, where its places are displaced by
    something between `drift_low` and `drift_high` [m]: what it does not overlap there never comes into it."""
    lower = low + ti.min(drift_low - tree.drift_high[node], 0.0)
    upper = high + ti.max(drift_high - tree.drift_low[node], 0.0)
    return lower, upper


@ti.func
def holds(tree: ti.template(), node: ti.i32, low: vec3, high: vec3) -> ti.i32:
    """Whether a box overlaps that of a node at the start."""
    return meet(low, high, tree.low[node], tree.high[node])


@ti.kernel
def clear(tree: BoxTree):
    """Make all boxes empty: from FAR to -FAR."""
    for k in range(2 * tree.leaves + GROUP * tree.leaves):
        tree.low[k] = vec3(FAR, FAR, FAR)
        tree.high[k] = vec3(-FAR, -FAR, -FAR)
        tree.drift_low[k] = vec3(FAR, FAR, FAR)
        tree.drift_high[k] = vec3(-FAR, -FAR, -FAR)


@ti.kernel
def enclose(corners: ti.template(), depth: ti.template(), half: Numbers, start: Vectors, end: Vectors, tree: BoxTree):
    """Boxes around primitives of so many points on their way from `start` to `end`, and `half` [m] beyond; then around
    boxes, from the leaves up."""
    for k in range(tree.primitives):
        lower, upper = vec3(FAR, FAR, FAR), vec3(-FAR, -FAR, -FAR)
        least, most = vec3(FAR, FAR, FAR), vec3(-FAR, -FAR, -FAR)
        for c in ti.static(range(corners)):
            i = tree.member[corners * k + c]
            drift = end[i] - start[i]
            lower, upper = ti.min(lower, start[i]), ti.max(upper, start[i])
            least, most = ti.min(least, drift), ti.max(most, drift)
        thick, node = half[tree.member[corners * k]], of_primitive(k, tree)
        tree.low[node] = lower - thick
        tree.high[node] = upper + thick
        tree.drift_low[node] = least
        tree.drift_high[node] = most
    for leaf in range(tree.leaves):
        _unite(tree.leaves + leaf, GROUP, of_primitive(GROUP * leaf, tree), tree)
    for step in ti.static(range(depth)):
        first = 1 << (depth - 1 - step)
        for k in range(first):
            _unite(first + k, 2, 2 * (first + k), tree)


@ti.func
def _unite(node: ti.i32, number: ti.template(), first: ti.i32, tree: ti.template()):
    """Let a node hold so many others, from the `first` on."""
    low, high, drift_low, drift_high = tree.low[first], tree.high[first], tree.drift_low[first], tree.drift_high[first]
    for k in ti.static(range(1, number)):
        low, high = ti.min(low, tree.low[first + k]), ti.max(high, tree.high[first + k])
        drift_low = ti.min(drift_low, tree.drift_low[first + k])
        drift_high = ti.max(drift_high, tree.drift_high[first + k])
    tree.low[node] = low
    tree.high[node] = high
    tree.drift_low[node] = drift_low
    tree.drift_high[node] = drift_high
