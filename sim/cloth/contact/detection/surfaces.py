"""The surfaces that cloth meets, its own and those of solids, with trees over their triangles and edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.cloth.contact.detection.search import TreeBoxes
from sim.cloth.fabric.arrays import integers, vectors
from sim.cloth.fabric.fabric import edges_of
from sim.device.compiler import ti
from sim.neighbors import box_tree


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


class Tree:
    """Boxes around primitives with so many corners, in an order of its own: `member` names their points."""

    def __init__(self, members: np.ndarray, places: np.ndarray):
        self.corners = members.shape[1]
        self.number = len(members)
        self.depth = max(int(np.ceil(np.log2(max(self.number, 1)))), 0)
        self.leaves = 1 << self.depth
        if self.number:
            members = members[box_tree.morton_order(places[members].mean(axis=1))]
        self.member = integers(members.ravel())
        self.low, self.high = vectors(np.zeros((2 * self.leaves, 3))), vectors(np.zeros((2 * self.leaves, 3)))
        box_tree.clear(2 * self.leaves, self.low, self.high)
        self.boxes = TreeBoxes(
            leaves=self.leaves, primitives=self.number, member=self.member, low=self.low, high=self.high
        )

    def enclose(self, half: ti.Ndarray, one: ti.Ndarray, other: ti.Ndarray) -> None:
        """Let boxes hold the primitives, `half` [m] as thick at points, at two times: places [m] `one` and `other`."""
        if self.number:
            box_tree.enclose_leaves(
                self.corners, self.number, self.leaves, self.member, half, one, other, self.low, self.high
            )
            box_tree.enclose_nodes(self.depth, self.low, self.high)

    @property
    def bytes(self) -> int:
        """Memory of the boxes and of the primitives' points [bytes]."""
        return 2 * 2 * self.leaves * 24 + 4 * self.corners * self.number
