"""Which boxes of two sets overlap, on the host."""

from __future__ import annotations

import numpy as np

from sim.neighbors.box_tree import FAR, morton_order


class Boxes:
    """Axis-parallel boxes [m], shapes [n, 3], in a full binary tree: node k has the children 2 k and 2 k + 1."""

    def __init__(self, low: np.ndarray, high: np.ndarray):
        self.depth = max(int(np.ceil(np.log2(max(len(low), 1)))), 0)
        self.leaves = 1 << self.depth
        self.order = morton_order((low + high) / 2) if len(low) else np.zeros(0, int)
        self.low, self.high = np.full((3, 2 * self.leaves), FAR), np.full((3, 2 * self.leaves), -FAR)
        own = slice(self.leaves, self.leaves + len(low))
        self.low[:, own], self.high[:, own] = low[self.order].T, high[self.order].T
        for level in reversed(range(self.depth)):
            nodes, below = slice(1 << level, 2 << level), slice(2 << level, 4 << level)
            self.low[:, nodes] = self.low[:, below].reshape(3, -1, 2).min(axis=2)
            self.high[:, nodes] = self.high[:, below].reshape(3, -1, 2).max(axis=2)

    @classmethod
    def around(cls, corners: np.ndarray) -> Boxes:
        """Of primitives with k corners [m], shape [n, k, 3]."""
        return cls(corners.min(axis=1), corners.max(axis=1))


def overlapping(one: Boxes, other: Boxes) -> np.ndarray:
    """Pairs of a box of each set that overlap or touch, shape [pairs, 2]; of a set with itself, each pair once."""
    itself = one is other
    a, b = np.ones((2, 1), np.int32)
    for level in range(max(one.depth, other.depth) + 1):
        for axis in range(3):
            meet = one.low[axis][a] <= other.high[axis][b]
            meet &= other.low[axis][b] <= one.high[axis][a]
            a, b = a[meet], b[meet]
        if level < max(one.depth, other.depth):
            a, b = _below(a, b, level < one.depth, level < other.depth)
        if itself:
            a, b = a[a <= b], b[a <= b]
    if itself:
        a, b = a[a < b], b[a < b]
    return np.column_stack([one.order[a - one.leaves], other.order[b - other.leaves]])


def _below(a: np.ndarray, b: np.ndarray, split_a: bool, split_b: bool) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of the children of nodes, or of the nodes that stay."""
    left = [2 * a, 2 * a + 1] if split_a else [a]
    right = [2 * b, 2 * b + 1] if split_b else [b]
    return np.concatenate([i for i in left for _ in right]), np.concatenate([j for _ in left for j in right])
