"""All cloth and solids as they are placed, and what of the cloth is through something."""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.cloth.untangling.contours import Topology
from sim.cloth.untangling.crossings import Crossings, Layers
from sim.cloth.untangling.filled import Filled

if TYPE_CHECKING:
    from sim.cloth.contact.solids import Solids
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import PlacedSheet

ROUNDING = 1e-8
"""Points that are deeper in solids than this share of the size of everything are inside."""


@dataclass(frozen=True)
class Intersections:
    """What is through something."""

    crossings: Crossings
    """Edges that go through triangles."""
    beyond: np.ndarray
    """Points beyond walls, and the walls, shape [n, 2]."""
    inside: list[tuple[np.ndarray, Filled]]
    """Pieces of cloth that are inside solids altogether: their points and the solid."""

    def __bool__(self) -> bool:
        return bool(len(self.crossings) or len(self.beyond) or self.inside)


class Placement:
    """Points of all sheets, then of solids: where they were placed and are [m], shape [n, 3] (`placed`, `places`)."""

    def __init__(self, sheets: list[PlacedSheet], state: ClothState, solids: Solids):
        self.sheets, self.solids = sheets, solids
        counts = [len(item.fabric.points) for item in sheets]
        starts = np.cumsum([0, *counts])
        self.count = int(starts[-1])
        """Points of cloth."""
        self.of_sheet = [slice(a, b) for a, b in itertools.pairwise(starts)]
        """The rows of each sheet."""
        known = [state.of(item.name) for item in sheets]
        begins = [
            item.fabric.points if found is None or len(found[0]) != count else found[0]
            for item, found, count in zip(sheets, known, counts, strict=True)
        ]
        fresh = [places is item.fabric.points for item, places in zip(sheets, begins, strict=True)]
        rows = list(zip(sheets, fresh, starts, strict=False))
        self.placed = np.concatenate([*(item.fabric.points for item in sheets), solids.points])
        self.places = np.concatenate([*begins, solids.points])
        self.begins = np.zeros(len(self.places), bool)
        self.begins[: self.count] = np.repeat(fresh, counts)
        """Whether points are of sheets that begin."""
        self.held = np.zeros(len(self.places), bool)
        self.held[: self.count] = np.concatenate([item.held for item in sheets])
        self.free = self.begins & ~self.held
        """Whether points may be moved."""
        self.half = np.zeros(len(self.places))
        self.half[: self.count] = np.repeat([item.sheet.thickness / 2 for item in sheets], counts)
        """Half the thickness at points [m]."""
        parts = [item.fabric.triangles + start for item, _, start in rows]
        self.layers = Layers([*parts, solids.triangles + self.count], [*counts, len(solids.points)])
        self._flat = np.array([new and item.sheet.shape.type == "sheet" for item, new, _ in rows] + [True])
        self._size = float(np.ptp(self.places, axis=0).max())
        self.of_filled = np.concatenate([np.zeros(self.count, bool), np.isin(solids.body, solids.filled)])
        self.filled = [Filled(solids, body) for body in solids.filled]
        springs = [np.concatenate([item.fabric.springs, item.fabric.hinges[:, 2:]]) + start for item, _, start in rows]
        self.springs = np.concatenate(springs)
        """Points that hang together, shape [s, 2]."""
        self.rest = np.linalg.norm(np.subtract(*self.placed[self.springs.T]), axis=1)
        """How far these were placed from each other [m], shape [s]."""

    @functools.cached_property
    def topology(self) -> Topology:
        """How points hang together by triangles."""
        return Topology(self.layers.triangles, self.placed)

    @functools.cached_property
    def piece(self) -> np.ndarray:
        """A number for each point, the same for those that hang together."""
        return self.topology.pieces()

    def corners(self, crossings: Crossings) -> np.ndarray:
        """Points of the triangles that edges go through, shape [n, 3]."""
        return self.layers.triangles[crossings.triangle]

    def intersect(self, *, as_placed: bool = False) -> Intersections:
        """What is through something; pieces inside of solids count once nothing else is, or `as_placed`."""
        crossings, beyond = self._cross(self._flat if as_placed else None), self._beyond()
        others = not as_placed and bool(len(crossings) or len(beyond))
        return Intersections(crossings, beyond, [] if others else self._inside())

    def _cross(self, flat: np.ndarray | None) -> Crossings:
        crossings = self.layers.cross(self.places, flat=flat)
        begins = self.begins[crossings.ends].any(axis=1) | self.begins[self.corners(crossings)].any(axis=1)
        return crossings.take(np.flatnonzero(begins))

    def _beyond(self) -> np.ndarray:
        pairs = [np.zeros((0, 2), int)]
        for index, wall in enumerate(self.solids.walls):
            height = self.places[: self.count] @ wall.normal - wall.offset
            low = np.flatnonzero((height < -ROUNDING * self._size) & self.free[: self.count])
            pairs.append(np.column_stack([low, np.full(len(low), index)]))
        return np.concatenate(pairs)

    def _inside(self) -> list[tuple[np.ndarray, Filled]]:
        found = []
        for body in self.filled:
            for own in self.of_sheet:
                points = np.arange(own.start, own.stop)[self.begins[own]]
                within = self.within(body, points)
                for piece in np.unique(self.piece[points[within]]) if within.any() else ():
                    rows = points[self.piece[points] == piece]
                    if within[self.piece[points] == piece].all():
                        found.append((rows, body))
        return found

    def within(self, body: Filled, points: np.ndarray) -> np.ndarray:
        """Whether points are inside a body, by more than rounding."""
        return body.holds(self.places[points], ROUNDING * self._size)

    def name(self, point: int) -> str:
        """The sheet or body that a point is of."""
        if point >= self.count:
            return self.solids.names[self.solids.body[point - self.count]]
        return next(item.name for item, own in zip(self.sheets, self.of_sheet, strict=True) if point < own.stop)
