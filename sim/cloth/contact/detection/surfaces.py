"""The surfaces that cloth meets, its own and those of solids, with trees over their triangles and edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.cloth.fabric.arrays import integers, vectors
from sim.cloth.fabric.fabric import edges_of
from sim.device.compiler import ti
from sim.neighbors import box_tree
from sim.neighbors.box_tree import BoxTree


@dataclass(frozen=True)
class Surface:
    """Points, of all of which the primitives are numbered, and how they hold what they touch."""

    points: np.ndarray
    """Those that count, shape [n]."""
    triangles: np.ndarray
    """Shape [t, 3]."""
    edges: np.ndarray
    """Shape [e, 2]."""

    @classmethod
    def of(cls, triangles: np.ndarray) -> Surface:
        """All points, triangles, shape [n, 3], and edges, once each."""
        edges = np.unique(np.sort(edges_of(triangles), axis=1), axis=0)
        return cls(np.unique(triangles), triangles, edges.reshape(-1, 2))

    def trees(self, places: np.ndarray) -> tuple[Tree, Tree, Tree]:
        """Of the points, triangles and edges, for places [m], shape [points, 3]."""
        points, triangles, edges = (
            Tree(members, places) for members in (self.points[:, np.newaxis], self.triangles, self.edges)
        )
        return points, triangles, edges


class Tree:
    """Boxes around primitives with so many corners, in an order of its own: `member` names their points, and `order`
    which they were, shape [n]."""

    def __init__(self, members: np.ndarray, places: np.ndarray):
        self.corners = members.shape[1]
        self.number = len(members)
        self.order = np.arange(self.number)
        if self.number:
            self.order = box_tree.morton_order(places[members].mean(axis=1))
        leaves = max(-(-self.number // box_tree.GROUP), 1)
        self._depth = int(np.ceil(np.log2(leaves)))
        leaves = 1 << self._depth
        self.member = integers(members[self.order].ravel())
        self._boxes = (2 + box_tree.GROUP) * leaves
        ends = ("low", "high", "drift_low", "drift_high")
        self.tree = BoxTree(
            leaves=leaves,
            primitives=self.number,
            member=self.member,
            **{name: vectors(np.zeros((self._boxes, 3))) for name in ends},
        )
        box_tree.clear(self.tree)

    def enclose(self, half: ti.Ndarray, start: ti.Ndarray, end: ti.Ndarray) -> None:
        """Let boxes hold the primitives, `half` [m] as thick at points, on their way from `start` to `end` [m]."""
        if self.number:
            box_tree.enclose(self.corners, self._depth, half, start, end, self.tree)

    @property
    def bytes(self) -> int:
        """Memory of the boxes and of the primitives' points [bytes]."""
        return 4 * 24 * self._boxes + 4 * self.corners * self.number
