"""Where edges go through triangles: of cloth through cloth, of cloth through solids, and of solids through cloth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.cloth.untangling.boxes import Boxes, overlapping

ASIDE = 1e-9
"""Parts are shifted by this share of the size of everything: edges that end in a triangle then cross it or do not."""
SHIFT = np.array([0.36, 0.80, 0.48])
UNEVEN = 0.01
"""Points are shifted by this share of that beside it, each another way."""


@dataclass(frozen=True)
class Crossings:
    """Edges that go through triangles."""

    ends: np.ndarray
    """Points of the edge, the lower number first, shape [n, 2]."""
    triangle: np.ndarray
    """Number of the triangle, shape [n]."""
    share: np.ndarray
    """How far along the edge, shape [n]."""
    weight: np.ndarray
    """Of the corners of the triangle there, shape [n, 3]."""
    upward: np.ndarray
    """Whether the edge goes from behind the triangle to before it, shape [n]."""

    def __len__(self) -> int:
        return len(self.ends)

    def take(self, rows: np.ndarray) -> Crossings:
        """Those of the given rows, in their order."""
        return Crossings(*(values[rows] for values in vars(self).values()))

    @classmethod
    def joined(cls, parts: list[Crossings]) -> Crossings:
        """All of them one after the other; of no parts, none."""
        none = cls(np.zeros((0, 2), int), np.zeros(0, int), np.zeros(0), np.zeros((0, 3)), np.zeros(0, bool))
        return cls(*(np.concatenate(part) for part in zip(*(vars(p).values() for p in [none, *parts]), strict=True)))


class Layers:
    """The surfaces of sheets, and last those of all solids, each a part of one mesh; solids may cross each other.

    parts: triangles of each part, shape [t, 3], their points numbered through; counts: how many points each part has.
    """

    def __init__(self, parts: list[np.ndarray], counts: list[int]):
        self.parts = len(parts)
        self.triangles = np.concatenate(parts)
        self.part_of_point = np.repeat(np.arange(self.parts), counts)
        self._first = np.cumsum([0] + [len(part) for part in parts])
        turns = np.random.default_rng(0).uniform(-UNEVEN, UNEVEN, (sum(counts), 3))
        self._shift = self.part_of_point[:, None] * SHIFT + turns

    def cross(self, places: np.ndarray, *, flat: np.ndarray | None = None) -> Crossings:
        """All crossings with points at `places` [m], shape [n, 3]; none where a shift by rounding would undo them all.

        flat: whether each part is known not to cross itself.
        """
        flat = np.zeros(self.parts, bool) if flat is None else flat
        aside = ASIDE * float(np.ptp(places, axis=0).max(initial=0.0)) * self._shift
        low, high = places - np.abs(aside), places + np.abs(aside)
        boxes = [
            Boxes(low[part].min(axis=1), high[part].max(axis=1)) for part in np.split(self.triangles, self._first[1:-1])
        ]
        pairs = [
            overlapping(boxes[one], boxes[other]) + self._first[[one, other]]
            for one in range(self.parts - 1)
            for other in range(one, self.parts)
            if one < other or not flat[one]
        ]
        near = np.concatenate([np.zeros((0, 2), int), *pairs])
        near = np.concatenate([near, near[:, ::-1]])
        found = self._through(places + aside, near)
        return found if len(found) and len(self._through(places - aside, near)) else found.take(np.zeros(0, int))

    def _through(self, places: np.ndarray, pairs: np.ndarray) -> Crossings:
        """Where edges of the first triangles of pairs go through the second, shape [n, 2]."""
        corners = places[self.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        one, other = (self.triangles[pairs[:, k]].T for k in range(2))
        apart = [(one[k] != other[0]) & (one[k] != other[1]) & (one[k] != other[2]) for k in range(3)]
        found = [np.zeros((0, 3), int)]
        for k in range(3):
            rows = np.flatnonzero(apart[k] & apart[(k + 1) % 3])
            ends, triangle = np.sort(one[[k, (k + 1) % 3]][:, rows].T, axis=1), pairs[rows, 1]
            crossed = self._split(places, ends, triangle, corners, normals)
            ends, triangle = ends[crossed], triangle[crossed]
            crossed = self._inside(places, ends, triangle)
            found.append(np.column_stack([ends, triangle])[crossed])
        # Both triangles at an edge have found what it crosses.
        ends, triangle = np.split(np.unique(np.concatenate(found), axis=0), [2], axis=1)
        triangle = triangle[:, 0]
        start, end = (_heights(places[ends[:, k]], triangle, corners, normals) for k in range(2))
        share = start / np.where(start == end, 1.0, start - end)
        across = places[ends[:, 0]] + share[:, None] * (places[ends[:, 1]] - places[ends[:, 0]])
        return Crossings(ends, triangle, share, barycentric(across, corners[triangle]), end > 0)

    def _split(
        self, places: np.ndarray, ends: np.ndarray, triangle: np.ndarray, corners: np.ndarray, normals: np.ndarray
    ) -> np.ndarray:
        """Numbers of the edges whose ends are on different sides of the triangles' planes."""
        before = (_heights(places[ends[:, k]], triangle, corners, normals) > 0 for k in range(2))
        return np.flatnonzero(np.logical_xor(*before))

    def _inside(self, places: np.ndarray, ends: np.ndarray, triangle: np.ndarray) -> np.ndarray:
        """Numbers of the edges whose lines pass all three sides of the triangles on one side."""
        left, rows = None, np.arange(len(ends))
        for k in range(3):
            start, along = places[ends[rows, 0]], places[ends[rows, 1]] - places[ends[rows, 0]]
            u, v = self.triangles[triangle[rows], k], self.triangles[triangle[rows], (k + 1) % 3]
            # From the lower point to the higher: the triangles on both sides of it have to agree.
            low, high = places[np.minimum(u, v)], places[np.maximum(u, v)]
            now = (np.einsum("ij,ij->i", np.cross(along, high - low), low - start) > 0) ^ (u > v)
            same = np.full(len(rows), True) if left is None else now == left
            rows, left = rows[same], now[same]
        return rows


def _heights(points: np.ndarray, triangle: np.ndarray, corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Of points above the planes of triangles, times twice the triangles' areas, shape [n]."""
    return np.einsum("ij,ij->i", points - corners[triangle, 0], normals[triangle])


def barycentric(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Weights of the corners [m], shape [n, 3, 3], of triangles at points in them, none below 0, shape [n, 3]."""
    u, v, w = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    normal = np.cross(u, v)
    size = np.maximum((normal**2).sum(axis=1), 1e-300)
    second, third = (np.cross(w, v) * normal).sum(axis=1) / size, (np.cross(u, w) * normal).sum(axis=1) / size
    weight = np.maximum(np.column_stack([1 - second - third, second, third]), 0.0)
    return weight / np.maximum(weight.sum(axis=1, keepdims=True), 1e-300)
