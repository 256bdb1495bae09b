"""A binary tree of boxes around primitives, for finding those near others.

The tree is full: node k has the children 2 k and 2 k + 1, leaves come last, and empty boxes fill them up. Which
primitive is in which leaf is decided once, by where it is then (Morton 1966); boxes follow the primitives.
"""

import numpy as np

from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Vectors, vec3

FAR = 1e30


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
    found = node
    while found % 2 == 1 and found > 1:
        found = found // 2
    found = ti.select(found > 1, found + 1, 0)
    return found


@ti.func
def meet(low: vec3, high: vec3, other_low: vec3, other_high: vec3) -> ti.i32:
    """Whether two boxes overlap."""
    return int((low <= other_high).all() and (other_low <= high).all())


@ti.kernel
def clear(nodes: ti.i32, low: Vectors, high: Vectors):
    """Make all boxes empty: from FAR to -FAR."""
    for k in range(nodes):
        low[k] = vec3(FAR, FAR, FAR)
        high[k] = -low[k]


@ti.kernel
def enclose_leaves(
    corners: ti.template(),
    number: ti.i32,
    leaves: ti.i32,
    member: Integers,
    half: Numbers,
    one: Vectors,
    other: Vectors,
    low: Vectors,
    high: Vectors,
):
    """Boxes around primitives of so many points, at both of two times, and `half` [m] beyond."""
    for k in range(number):
        lower, upper = vec3(FAR, FAR, FAR), vec3(-FAR, -FAR, -FAR)
        for c in ti.static(range(corners)):
            i = member[corners * k + c]
            lower = ti.min(lower, ti.min(one[i], other[i]))
            upper = ti.max(upper, ti.max(one[i], other[i]))
        thick = half[member[corners * k]]
        low[leaves + k] = lower - thick
        high[leaves + k] = upper + thick


@ti.kernel
def enclose_nodes(depth: ti.template(), low: Vectors, high: Vectors):
    """Boxes around boxes, from the leaves up."""
    for step in ti.static(range(depth)):
        first = 1 << (depth - 1 - step)
        for k in range(first):
            node = first + k
            low[node] = ti.min(low[2 * node], low[2 * node + 1])
            high[node] = ti.max(high[2 * node], high[2 * node + 1])
