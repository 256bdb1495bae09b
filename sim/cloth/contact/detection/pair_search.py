"""The search of one kind of pairs: points against triangles, or edges against edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.cloth.contact.detection import search
from sim.cloth.contact.detection.crowding import Crowding
from sim.cloth.contact.detection.search import Hits, SweptPoints
from sim.cloth.contact.detection.surfaces import Tree
from sim.cloth.fabric.arrays import integers, vectors
from sim.device.compiler import ti
from sim.neighbors.box_tree import GROUP

ROOM = 8
"""Hits of one point or edge that there is room for at first."""


@dataclass(frozen=True)
class Pairs:
    """What a search has found, one row a pair."""

    corners: np.ndarray
    """Points, shape [n, 4]."""
    weight: np.ndarray
    """Of these where they come near, shape [n, 4]."""
    normal: np.ndarray
    """Towards the first primitive, shape [n, 3]."""
    narrow: np.ndarray
    """1 where they come too near, shape [n]."""


class PairSearch:
    """Looks for the points, or `edges`, of one tree among the primitives of another, which may be the same."""

    def __init__(self, edges: bool, query: Tree, tree: Tree, own: Crowding | None = None):
        """`own`: where cloth is looked for that may be a neighbour."""
        self.edges, self.itself = edges, query is tree
        self._crowding = own if own and own.present else None
        self._query, self._tree = query, tree
        # Contacts of points follow one another as points do, whatever the tree.
        self._order = np.arange(query.number) if edges else query.order
        self._swept: dict[tuple[int, ...], SweptPoints] = {}
        self._make_room(ROOM)

    def _make_room(self, room: int) -> None:
        self._room, queries = room, -(-self._query.number // GROUP) * GROUP
        slots = room * queries
        self._hits = Hits(
            corner=integers(np.zeros(4 * slots)),
            weight=ti.Vector.ndarray(4, ti.f64, max(slots, 1)),
            toward=vectors(np.zeros((slots, 3))),
            narrow=integers(np.zeros(slots)),
            hit_count=integers(np.zeros(queries)),
        )

    def run(self, half: ti.Ndarray, start: ti.Ndarray, end: ti.Ndarray, early: float) -> Pairs:
        """Pairs that come nearer than `early` of their thickness, of which there is `half` [m] at points, on the way
        from `start` to `end` [m]."""
        points = self._points(half, start, end)
        while True:
            search.find_near(
                self.edges,
                int(self.itself),
                int(self._crowding is not None),
                self._room,
                early,
                self._query.tree,
                self._tree.tree,
                points,
                self._hits,
            )
            number = self._hits.hit_count.to_numpy()[: self._query.number]
            if number.max(initial=0) <= self._room:
                break
            self._make_room(2 * int(number.max()))
        total = int(number.sum())
        corners, narrow = np.zeros((total, 4), np.int32), np.zeros(total, np.int32)
        weight, normal = np.zeros((total, 4)), np.zeros((total, 3))
        if total:
            each = np.empty_like(number)
            each[self._order] = number
            first = integers((np.cumsum(each) - each)[self._order])
            search.gather(len(number), self._room, first, self._hits, corners, weight, normal, narrow)
        return Pairs(corners, weight, normal, narrow)

    def _points(self, half: ti.Ndarray, start: ti.Ndarray, end: ti.Ndarray) -> SweptPoints:
        """One pack for each pair of places: an integrator comes with the same few arrays again and again."""
        rest = self._crowding.places if self._crowding else start
        arrays = half, start, end, rest
        key = tuple(map(id, arrays))
        if key not in self._swept:
            self._swept[key] = SweptPoints(half=half, start=start, end=end, rest=rest)
        return self._swept[key]
