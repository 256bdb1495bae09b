"""Cloth that is placed through itself, another sheet or a solid is moved apart before the first step.

Round by round: contours along which surfaces cross are found (`contours`), the piece that is on the wrong side of the
other surface is pushed back through it, and the cloth follows as a whole (`relaxation`), so that a sheet that nothing
holds goes aside rather than being stretched. A contour that cuts nothing off is made shorter. What is inside a solid
altogether goes out the shortest way.
"""

from __future__ import annotations

import functools
import itertools
from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.cloth.untangling.casting import cast
from sim.cloth.untangling.contours import Contour, Piece, Topology, cut_off, patch, shortening, trace
from sim.cloth.untangling.crossings import Crossings, Layers
from sim.cloth.untangling.filled import Filled
from sim.cloth.untangling.relaxation import Pushes, relax

if TYPE_CHECKING:
    from sim.cloth.contact.solids import Solids
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import PlacedSheet

ROUNDS = 100
FORCE, GROWTH, MOST_FORCE = 0.1, 1.1, 1e3
"""How firmly cloth is pushed in the first round; by how much more in each; and at most."""
WORSE = 4
"""With so many times the crossings of the start it is given up."""
STRIDE = 1.0
"""Cloth is pushed through by so many mean edges in a round: what hangs on it can follow."""
ALIKE = 1.1
"""Areas within this factor count as the same: a row of points more or less makes such a difference."""
NOTICEABLE = 0.01
"""Points that went further than this share of the thickness were moved."""
ROUNDING = 1e-8
"""Points that are deeper in solids than this share of the size of everything are inside."""


@dataclass(frozen=True)
class Untangled:
    """What became of a sheet that was placed through something, or was in the way of another."""

    sheet: str
    crossings: int
    """Edges through triangles, points beyond walls, and pieces inside solids."""
    through: list[str]
    """What it was placed through."""
    points: int
    """How many were moved."""
    furthest: float
    """By how much at most [m]."""

    def line(self) -> str:
        """What the user is told: through what the sheet is placed, how often, and how far its points were moved."""
        moved = f"{self.points} of its points were moved by up to {self.furthest * 1000:.3g} mm"
        if not self.crossings:
            return f"the sheet '{self.sheet}' was in the way of another: {moved}"
        through = f"{_listed(self.sheet, self.through)}, {self.crossings} times"
        return f"the sheet '{self.sheet}' is placed through {through}: {moved}, and it begins there"


def untangle(
    sheets: list[PlacedSheet], state: ClothState, solids: Solids, up: np.ndarray
) -> tuple[list[PlacedSheet], list[Untangled]]:
    """The sheets with the places where they begin, and what was done; those in `state` stay where they are. `up`: unit
    vector against gravity, by which cloth goes where it may as well go down.

    Raises Refused where there is no way out.
    """
    tangle = _Tangle(sheets, state, solids, up)
    report = tangle.resolve() if tangle.loose.any() else []
    moved = {item.sheet for item in report}
    rows = zip(sheets, tangle.of_sheet, strict=True)
    return [replace(item, moved=tangle.places[own]) if item.name in moved else item for item, own in rows], report


class _Tangle:
    """All cloth and solids, and what they are placed through."""

    def __init__(self, sheets: list[PlacedSheet], state: ClothState, solids: Solids, up: np.ndarray):
        self.sheets, self.solids, self._up = sheets, solids, up
        counts = [len(item.fabric.points) for item in sheets]
        starts = np.cumsum([0, *counts])
        self.count = int(starts[-1])
        self.of_sheet = [slice(a, b) for a, b in itertools.pairwise(starts)]
        known = [state.of(item.name) for item in sheets]
        fresh = [found is None or len(found[0]) != count for found, count in zip(known, counts, strict=True)]
        rows = list(zip(sheets, known, fresh, counts, starts, strict=False))
        self.placed = np.concatenate([*(item.fabric.points for item in sheets), solids.points])
        self.places = np.concatenate(
            [*(item.fabric.points if new else found[0] for item, found, new, *_ in rows), solids.points]
        )
        self.loose = np.zeros(len(self.places), bool)
        self.loose[: self.count] = np.repeat(fresh, counts)
        """Points of sheets that begin."""
        self._held = np.zeros(len(self.places), bool)
        self._held[: self.count] = np.concatenate([item.held for item in sheets])
        self._free = self.loose & ~self._held
        self._half = np.zeros(len(self.places))
        self._half[: self.count] = np.repeat([item.sheet.thickness / 2 for item in sheets], counts)
        parts = [item.fabric.triangles + start for item, *_, start in rows]
        self._layers = Layers([*parts, solids.triangles + self.count], [*counts, len(solids.points)])
        self._flat = np.array([new and item.sheet.shape.type == "sheet" for item, _, new, *_ in rows] + [True])
        self._size = float(np.ptp(self.places, axis=0).max())
        self._of_filled = np.concatenate([np.zeros(self.count, bool), np.isin(solids.body, solids.filled)])
        self._one_by_one = False
        """Whether only one pair of surfaces is taken apart in a round."""
        self._filled = [Filled(solids, body) for body in solids.filled]
        springs = [np.concatenate([item.fabric.springs, item.fabric.hinges[:, 2:]]) + start for item, *_, start in rows]
        self._springs = np.concatenate(springs)
        self._rest = np.linalg.norm(np.subtract(*self.placed[self._springs.T]), axis=1)
        self._stride = STRIDE * float(self._rest.mean())

    @functools.cached_property
    def _topology(self) -> Topology:
        return Topology(self._layers.triangles, self.placed)

    @functools.cached_property
    def _whole(self) -> np.ndarray:
        """A number for each point, the same for those that hang together."""
        return self._topology.pieces()

    def resolve(self) -> list[Untangled]:
        """Move cloth until it is through nothing; returns what was done."""
        begin = self.places.copy()
        crossings, beyond, inside = self._cross(self._flat), self._beyond(), self._inside()
        if not (len(crossings) or len(beyond) or inside):
            return []
        found = self._tell(crossings, beyond, inside)
        self._refuse_pins_inside()
        try:
            self._go_apart(crossings, beyond, inside)
        except Refused:
            # Sheets that go out of each other's way all at once may hinder one another.
            self._one_by_one, self.places = True, begin.copy()
            self._go_apart(crossings, beyond, inside)
        return self._moved(begin, found)

    def _go_apart(self, crossings: Crossings, beyond: np.ndarray, inside: list[tuple[np.ndarray, Filled]]) -> None:
        force, most = FORCE, WORSE * (len(crossings) + len(self.sheets))
        for _ in range(ROUNDS):
            if len(crossings) > most:
                raise self._refused(crossings)
            if len(crossings) or len(beyond):
                self._push(crossings, beyond, force)
                force = min(GROWTH * force, MOST_FORCE)
            elif inside:
                for points, body in inside:
                    self._take_out(points, body)
            else:
                break
            crossings, beyond = self._cross(), self._beyond()
            inside = [] if len(crossings) or len(beyond) else self._inside()
        else:
            raise self._refused(crossings, beyond, inside)

    def _cross(self, flat: np.ndarray | None = None) -> Crossings:
        crossings = self._layers.cross(self.places, flat=flat)
        loose = self.loose[crossings.ends].any(axis=1) | self.loose[self._corners(crossings)].any(axis=1)
        return crossings.take(np.flatnonzero(loose))

    def _corners(self, crossings: Crossings) -> np.ndarray:
        return self._layers.triangles[crossings.triangle]

    def _beyond(self) -> np.ndarray:
        """Points beyond walls, and the walls, shape [n, 2]."""
        pairs = [np.zeros((0, 2), int)]
        for index, wall in enumerate(self.solids.walls):
            height = self.places[: self.count] @ wall.normal - wall.offset
            low = np.flatnonzero((height < -ROUNDING * self._size) & self._free[: self.count])
            pairs.append(np.column_stack([low, np.full(len(low), index)]))
        return np.concatenate(pairs)

    def _inside(self) -> list[tuple[np.ndarray, Filled]]:
        """Pieces of cloth that are inside solids altogether: their points and the solid."""
        found = []
        for body in self._filled:
            for own in self.of_sheet:
                points = np.arange(own.start, own.stop)[self.loose[own]]
                within = body.holds(self.places[points], ROUNDING * self._size)
                for piece in np.unique(self._whole[points[within]]) if within.any() else ():
                    rows = points[self._whole[points] == piece]
                    if within[self._whole[points] == piece].all():
                        found.append((rows, body))
        return found

    def _refuse_pins_inside(self) -> None:
        for body in self._filled:
            points = np.flatnonzero(self._held & self.loose)
            points = points[body.holds(self.places[points], ROUNDING * self._size)]
            if len(points):
                place = np.round(self.places[points[0]], 4).tolist()
                raise Refused(
                    f"a pin holds the sheet inside '{body.name}', at {place}",
                    location=("cloth", "sheets", self._name(points[0]), "pins"),
                    remedy=f"pin it elsewhere, or move it or '{body.name}'",
                )

    def _push(self, crossings: Crossings, beyond: np.ndarray, force: float) -> None:
        """Let cloth follow one round of pushes."""
        stuck = ~(self._free[crossings.ends].any(axis=1) | self._free[self._corners(crossings)].any(axis=1))
        if stuck.any():
            raise self._refused(crossings.take(np.flatnonzero(stuck)))
        pushes = Pushes.joined([*self._from_contours(crossings), *self._from_walls(beyond)])
        pushes = pushes.take(np.flatnonzero(~pushes.held(self._free)))
        moved = np.unique(self._whole[pushes.points[pushes.weight != 0]])
        free = self._free & np.isin(self._whole, moved)
        self.places = relax(self.places, self._springs, self._rest, free, pushes, force)

    def _from_walls(self, beyond: np.ndarray) -> list[Pushes]:
        found = []
        for index, wall in enumerate(self.solids.walls):
            points = beyond[beyond[:, 1] == index, 0]
            lacking = wall.offset + self._half[points] - self.places[points] @ wall.normal
            wanted = self.places[points] + lacking[:, None] * wall.normal
            found.append(Pushes.of(points[:, None], np.ones((len(points), 1)), wanted))
        return found

    def _from_contours(self, crossings: Crossings) -> list[Pushes]:
        if not len(crossings):
            return []
        label, found = self._topology.pieces(crossings.ends), []
        contours = trace(self._topology, crossings)
        if self._one_by_one:
            pairs = [self._parts(crossings, contour) for contour in contours]
            contours = [contour for contour, pair in zip(contours, pairs, strict=True) if pair == min(pairs)]
        for contour in contours:
            pieces = self._upward(cut_off(self._topology, crossings, contour, label, self.places, self._of_filled))
            choices = [self._push_back(crossings, piece) for piece in pieces]
            possible = [pushes for pushes in choices if not pushes.held(self._free).any()]
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
        return upward if piece.points[0] < self.count else -upward

    def _parts(self, crossings: Crossings, contour: Contour) -> list[int]:
        """The two surfaces that cross along a contour."""
        row = contour.rows[0]
        points = np.array([crossings.ends[row, 0], self._corners(crossings)[row, 0]])
        return sorted(self._layers.part_of_point[points].tolist())

    def _push_back(self, crossings: Crossings, piece: Piece) -> Pushes:
        """A piece goes back through the other surface, or that gives way."""
        triangles = self._layers.triangles
        other = triangles[patch(self._topology, crossings, piece)]
        inside = np.zeros(len(self.places), bool)
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
        row, face, weight, gap = cast(self.places[points], self.places[triangles], direction)
        point, corners = points[row], triangles[face]
        apart = self._half[point] + self._half[corners[:, 0]]
        apart = np.minimum(apart, self._stride - gap)
        members, factors = np.column_stack([point, corners]), np.column_stack([np.ones(len(row)), -weight])
        return Pushes.of(members, factors, apart[:, None] * direction)

    def _across(self, crossings: Crossings, direction: np.ndarray) -> Pushes:
        """Edges go their ways, in thicknesses, shape [n, 3], against the triangles that they cross, where they do."""
        corners = self._corners(crossings)
        apart = self._half[crossings.ends[:, 0]] + self._half[corners[:, 0]]
        return self._against(crossings, apart[:, None] * direction)

    def _shorten(self, crossings: Crossings, contour: Contour) -> Pushes:
        displacement = shortening(self._topology, crossings, contour, self.places)
        cut = crossings.take(contour.rows)
        return self._against(cut, self._stride * displacement)

    def _against(self, crossings: Crossings, displacement: np.ndarray) -> Pushes:
        """Edges go their ways [m], shape [n, 3], against the triangles that they cross, where they do."""
        share = crossings.share[:, None]
        factors = np.concatenate([1 - share, share, -crossings.weight], axis=1)
        return Pushes.of(np.concatenate([crossings.ends, self._corners(crossings)], axis=1), factors, displacement)

    def _take_out(self, points: np.ndarray, body: Filled) -> None:
        displacement = body.way_out(self.places[points])
        length = np.linalg.norm(displacement)
        self.places[points] += displacement * (1 + 2 * self._half[points].max() / length)

    def _name(self, point: int) -> str:
        """The sheet or body that a point is of."""
        if point >= self.count:
            return self.solids.names[self.solids.body[point - self.count]]
        return next(item.name for item, own in zip(self.sheets, self.of_sheet, strict=True) if point < own.stop)

    def _tell(self, crossings: Crossings, beyond: np.ndarray, inside: list) -> dict[str, Counter]:
        """How often sheets are through what."""
        found = {item.name: Counter() for item in self.sheets}
        ends = np.column_stack([crossings.ends[:, 0], self._corners(crossings)[:, 0]])
        pairs = [(self._name(one), self._name(other)) for one, other in ends]
        pairs += [(self._name(point), self.solids.wall_names[wall]) for point, wall in beyond]
        pairs += [(self._name(points[0]), body.name) for points, body in inside]
        for one, other in pairs:
            for sheet, partner in {(one, other), (other, one)}:
                if sheet in found:
                    found[sheet][partner] += 1
        return found

    def _moved(self, begin: np.ndarray, found: dict[str, Counter]) -> list[Untangled]:
        told = []
        for item, own in zip(self.sheets, self.of_sheet, strict=True):
            displacement = np.linalg.norm(self.places[own] - begin[own], axis=1)
            points = int((displacement > NOTICEABLE * item.sheet.thickness).sum())
            if points or found[item.name]:
                told.append(
                    Untangled(
                        item.name, found[item.name].total(), list(found[item.name]), points, float(displacement.max())
                    )
                )
        return told

    def _refused(self, crossings: Crossings, beyond: np.ndarray = (), inside: list = ()) -> Refused:
        told = self._tell(crossings, beyond, inside)
        sheet = max(told, key=lambda name: told[name].total())
        through = _listed(sheet, list(told[sheet]))
        return Refused(
            f"the sheet is placed through {through}, and no way apart was found that leaves its pins where they are",
            location=("cloth", "sheets", sheet),
            remedy="move it or what it is placed through, or let it hang on other pins",
        )


def _listed(sheet: str, others: list[str]) -> str:
    names = ["itself" if name == sheet else f"'{name}'" for name in others]
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
