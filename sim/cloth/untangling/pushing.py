"""Which way cloth that is through something is to go in one round."""

from __future__ import annotations

import numpy as np

from sim.cloth.untangling.casting import cast
from sim.cloth.untangling.contours import Contour, Piece, cut_off, patch, shortening, trace
from sim.cloth.untangling.crossings import Crossings
from sim.cloth.untangling.placement import Intersections, Placement
from sim.cloth.untangling.relaxation import Pushes

STRIDE = 1.0
"""Cloth is pushed through by so many mean edges in a round: what hangs on it can follow."""
ALIKE = 1.1
"""Areas within this factor count as the same: a row of points more or less makes such a difference."""


class Pushing:
    """Finds pushes of cloth in a placement; `up`: unit vector against gravity, by which cloth goes where it may as well
    go down; `one_by_one`: only one pair of surfaces is taken apart in a round."""

    def __init__(self, placement: Placement, up: np.ndarray, *, one_by_one: bool):
        self._placement, self._up, self._one_by_one = placement, up, one_by_one
        self._stride = STRIDE * float(placement.rest.mean())

    def pushes(self, found: Intersections) -> Pushes:
        """Those that free points can follow."""
        pushes = Pushes.joined([*self._from_contours(found.crossings), *self._from_walls(found.beyond)])
        return pushes.take(np.flatnonzero(~pushes.held(self._placement.free)))

    def _from_walls(self, beyond: np.ndarray) -> list[Pushes]:
        found, places = [], self._placement.places
        for index, wall in enumerate(self._placement.solids.walls):
            points = beyond[beyond[:, 1] == index, 0]
            lacking = wall.offset + self._placement.half[points] - places[points] @ wall.normal
            wanted = places[points] + lacking[:, None] * wall.normal
            found.append(Pushes.of(points[:, None], np.ones((len(points), 1)), wanted))
        return found

    def _from_contours(self, crossings: Crossings) -> list[Pushes]:
        if not len(crossings):
            return []
        placement, topology, found = self._placement, self._placement.topology, []
        label, contours = topology.pieces(crossings.ends), trace(topology, crossings)
        if self._one_by_one:
            pairs = [self._parts(crossings, contour) for contour in contours]
            contours = [contour for contour, pair in zip(contours, pairs, strict=True) if pair == min(pairs)]
        for contour in contours:
            pieces = cut_off(topology, crossings, contour, label, placement.places, placement.of_filled)
            choices = [self._push_back(crossings, piece) for piece in self._upward(pieces)]
            possible = [pushes for pushes in choices if not pushes.held(placement.free).any()]
            found.append((possible or choices or [self._shorten(crossings, contour)])[0])
        return found

    def _upward(self, pieces: list[Piece]) -> list[Piece]:
        """Of pieces as small as the smallest, first those that let cloth rise: it then lies on what it was through."""
        if not pieces:
            return []
        least = ALIKE * pieces[0].area
        return sorted(pieces, key=lambda piece: (piece.area > least, self._rise(piece) < 0, piece.area))

    def _rise(self, piece: Piece) -> float:
        """How far cloth rises where a piece goes back by 1, or pushes it."""
        upward = float(piece.direction @ self._up)
        return upward if piece.points[0] < self._placement.count else -upward

    def _parts(self, crossings: Crossings, contour: Contour) -> list[int]:
        """The two surfaces that cross along a contour."""
        row = contour.rows[0]
        points = np.array([crossings.ends[row, 0], self._placement.corners(crossings)[row, 0]])
        return sorted(self._placement.layers.part_of_point[points].tolist())

    def _push_back(self, crossings: Crossings, piece: Piece) -> Pushes:
        """A piece goes back through the other surface, or that gives way."""
        triangles = self._placement.layers.triangles
        other = triangles[patch(self._placement.topology, crossings, piece)]
        inside = np.zeros(len(self._placement.places), bool)
        inside[piece.points] = True
        own = triangles[inside[triangles].any(axis=1)]
        ahead, behind = np.ones((len(piece.edges), 1)), -np.ones((len(piece.triangles), 1))
        return Pushes.joined(
            [
                self._through(piece.points, other, piece.direction),
                self._through(np.unique(other), own, -piece.direction),
                self._across(crossings.take(piece.edges), ahead * piece.direction),
                self._across(crossings.take(piece.triangles), behind * piece.direction),
            ]
        )

    def _through(self, points: np.ndarray, triangles: np.ndarray, direction: np.ndarray) -> Pushes:
        """Points go a stride along a unit vector, but no further than beyond the triangles that they meet on it."""
        places, half = self._placement.places, self._placement.half
        row, face, weight, gap = cast(places[points], places[triangles], direction)
        point, corners = points[row], triangles[face]
        apart = half[point] + half[corners[:, 0]]
        apart = np.minimum(apart, self._stride - gap)
        members, factors = np.column_stack([point, corners]), np.column_stack([np.ones(len(row)), -weight])
        return Pushes.of(members, factors, apart[:, None] * direction)

    def _across(self, crossings: Crossings, direction: np.ndarray) -> Pushes:
        """Edges go these ways, in thicknesses, shape [n, 3], against the triangles that they cross, where they do."""
        half, corners = self._placement.half, self._placement.corners(crossings)
        apart = half[crossings.ends[:, 0]] + half[corners[:, 0]]
        return self._against(crossings, apart[:, None] * direction)

    def _shorten(self, crossings: Crossings, contour: Contour) -> Pushes:
        displacement = shortening(self._placement.topology, crossings, contour, self._placement.places)
        return self._against(crossings.take(contour.rows), self._stride * displacement)

    def _against(self, crossings: Crossings, displacement: np.ndarray) -> Pushes:
        """Edges go by displacements [m], shape [n, 3], against the triangles that they cross, where they do."""
        share = crossings.share[:, None]
        factors = np.concatenate([1 - share, share, -crossings.weight], axis=1)
        points = np.concatenate([crossings.ends, self._placement.corners(crossings)], axis=1)
        return Pushes.of(points, factors, displacement)
