"""Inside or outside of triangle meshes, by the winding number.

A vertical ray from a point to infinity crosses the surface; crossings out of the solid minus crossings
into it are the winding number (1 inside one closed component, 2 where two overlap, 0 outside). Each
crossing is decided by the signs of the three edge functions of the projected triangle. Ties are broken as if
every query were moved by (e, e^2) (Edelsbrunner & Mücke 1990, simulation of simplicity), and an edge is
evaluated from its lower to its higher vertex, so that two triangles always agree on their common edge.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import trimesh

# Pairs of query and candidate triangle held at once: bounds memory at about 200 MB.
_PAIRS_AT_ONCE = 2_000_000


def expand(starts: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All (row, start + 0 ... start + count - 1) of ragged rows, as two flat index arrays."""
    rows = np.repeat(np.arange(len(counts)), counts)
    offsets = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    return rows, starts[rows] + offsets


class WindingNumber:
    """Winding numbers of a mesh, by columns parallel to z over a grid of candidate triangles."""

    def __init__(self, mesh: trimesh.Trimesh):
        # Contiguous copies: the sign of an edge function must not depend on who asks.
        self._vertices = np.array(mesh.vertices, dtype=np.float64)
        self._faces = np.array(mesh.faces, dtype=np.int64)
        flat = self._vertices[self._faces][:, :, :2]
        self._low = flat.min(axis=(0, 1))
        self._high = flat.max(axis=(0, 1))
        extent = np.maximum(self._high - self._low, 1e-300)
        cells = float(np.clip(len(self._faces), 64, 2**20))
        aspect = np.clip(extent[0] / extent[1], 1 / cells, cells)
        self._shape = np.maximum(1, np.round([np.sqrt(cells * aspect), np.sqrt(cells / aspect)])).astype(np.int64)
        self._cell = extent / self._shape
        first = self._cell_of(flat.min(axis=1))
        last = self._cell_of(flat.max(axis=1))
        spans = last - first + 1
        faces, local = expand(np.zeros(len(spans), dtype=np.int64), spans.prod(axis=1))
        cell = (first[faces, 0] + local // spans[faces, 1]) * self._shape[1] + first[faces, 1] + local % spans[faces, 1]
        self._candidates = faces[np.argsort(cell, kind="stable")]
        self._counts = np.bincount(cell, minlength=int(self._shape.prod()))
        self._starts = np.cumsum(self._counts) - self._counts

    def at(self, points: np.ndarray) -> np.ndarray:
        """Winding numbers at `points` [m], shape [n, 3]; shape [n]."""
        points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        number = np.zeros(len(points), dtype=np.int64)
        for query, height, sign in self._crossings(points[:, :2]):
            above = height > points[query, 2]
            np.add.at(number, query[above], sign[above])
        return number

    def on_lattice(self, origin: np.ndarray, spacing: float, shape: tuple[int, int, int]) -> np.ndarray:
        """Winding numbers on a cubic lattice, whose first point is `origin` [m]; an int array of `shape`.

        One column of the lattice costs as much as one point of `at`.
        """
        nx, ny, nz = shape
        x, y = np.meshgrid(origin[0] + spacing * np.arange(nx), origin[1] + spacing * np.arange(ny), indexing="ij")
        levels = origin[2] + spacing * np.arange(nz)
        change = np.zeros((nx * ny, nz + 1), dtype=np.int64)
        for column, height, sign in self._crossings(np.column_stack([x.ravel(), y.ravel()])):
            # All levels below the crossing see it.
            np.add.at(change, (column, np.searchsorted(levels, height, side="left")), sign)
        below = np.cumsum(change[:, ::-1], axis=1)[:, ::-1]
        return below[:, 1:].reshape(shape)

    def counted_wrongly(self, columns: np.ndarray) -> np.ndarray:
        """Length [m] of vertical lines at `columns` [m], shape [n, 2], where the winding number is neither 0 nor 1."""
        return self._length_where(columns, lambda number: (number != 0) & (number != 1))

    def length_within(self, columns: np.ndarray) -> np.ndarray:
        """Length [m] of vertical lines at `columns` [m], shape [n, 2], where the winding number is positive."""
        return self._length_where(columns, lambda number: number > 0)

    def length_inside_out(self, columns: np.ndarray) -> np.ndarray:
        """Length [m] of vertical lines at `columns` [m], shape [n, 2], where the winding number is negative."""
        return self._length_where(columns, lambda number: number < 0)

    def _length_where(self, columns: np.ndarray, counts: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        length = np.zeros(len(columns))
        for column, height, sign in self._crossings(columns):
            order = np.lexsort((height, column))
            column, height = column[order], height[order]
            # The number above a crossing; every column of a closed mesh ends with 0.
            number = -np.cumsum(sign[order])[:-1]
            meant = (column[1:] == column[:-1]) & counts(number)
            np.add.at(length, column[:-1][meant], np.diff(height)[meant])
        return length

    def _cell_of(self, flat: np.ndarray) -> np.ndarray:
        return np.clip(np.floor((flat - self._low) / self._cell), 0, self._shape - 1).astype(np.int64)

    def _crossings(self, columns: np.ndarray):
        """Yield (column, height [m], sign) of the crossings of vertical lines, in portions."""
        within = np.flatnonzero(((columns >= self._low) & (columns <= self._high)).all(axis=1))
        cell = self._cell_of(columns[within])
        cell = cell[:, 0] * self._shape[1] + cell[:, 1]
        counts = self._counts[cell]
        portion = (np.cumsum(counts) - counts) // _PAIRS_AT_ONCE
        edges = np.flatnonzero(np.diff(portion)) + 1
        for part in np.split(np.arange(len(within)), edges):
            rows, slots = expand(self._starts[cell[part]], counts[part])
            yield self._cross(columns, within[part[rows]], self._candidates[slots])

    def _cross(self, columns: np.ndarray, query: np.ndarray, face: np.ndarray):
        at = columns[query]
        box = self._vertices[self._faces[face]][:, :, :2]
        near = ((box.min(axis=1) <= at) & (box.max(axis=1) >= at)).all(axis=1)
        query, face, at = query[near], face[near], at[near]
        corners = self._faces[face]
        value = np.empty((len(face), 3))
        left = np.empty((len(face), 3), dtype=bool)
        for edge in range(3):
            value[:, edge], left[:, edge] = self._edge(corners[:, (edge + 1) % 3], corners[:, (edge + 2) % 3], at)
        upward = left.all(axis=1)
        crossed = upward | (~left).all(axis=1)
        weight = np.abs(value[crossed])
        total = weight.sum(axis=1)
        z = self._vertices[corners[crossed], 2]
        # A triangle seen edge-on, decided by the tie-break alone, has no weights: any of its heights serves.
        flat = total == 0
        weight[flat] = 1.0
        total[flat] = 3.0
        height = (weight * z).sum(axis=1) / total
        return query[crossed], height, np.where(upward[crossed], 1, -1)

    def _edge(self, a: np.ndarray, b: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Edge function of a -> b at a point, and whether the (moved) point lies to the left."""
        swapped = a > b
        start = self._vertices[np.where(swapped, b, a)]
        end = self._vertices[np.where(swapped, a, b)]
        dx, dy = end[:, 0] - start[:, 0], end[:, 1] - start[:, 1]
        value = dx * (at[:, 1] - start[:, 1]) - dy * (at[:, 0] - start[:, 0])
        left = np.where(value != 0, value > 0, np.where(dy != 0, dy < 0, dx > 0))
        return np.where(swapped, -value, value), left ^ swapped
