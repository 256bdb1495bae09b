"""Neighbour search by compact spatial hashing.

Space is divided into cubic cells with the edge of the support radius, numbered periodically: cell
(x, y, z) has the same number as its images a period away, so that memory follows the number of
particles and no domain bounds the scene. Far images share a cell and drop out by their distance.
Within a period the numbering is linear, so that the three cells of a row lie together in memory.
"""

from typing import Protocol

import numpy as np
import taichi as ti

from sim.arrays import IntArray, IntTable, Vec4Array

CELLS_PER_PARTICLE = 4
SCAN_CHUNK = 1024
MIN_PERIOD = 8
ROWS = tuple((dy, dz) for dz in (-1, 0, 1) for dy in (-1, 0, 1))
"""Rows of three cells around a particle's cell, nearest in memory first."""


def period_for(count: int) -> int:
    """Cells along each axis of a period: a power of two, with room for splashes."""
    period = MIN_PERIOD
    while period**3 < CELLS_PER_PARTICLE * count:
        period *= 2
    return period


class Cells(Protocol):
    """Particles sorted by cell: those of cell c are first[c] up to, without, last[c]."""

    cell_size: float
    period: int
    first: ti.Ndarray
    last: ti.Ndarray


class HashGrid:
    """Cells of `count` particles that move."""

    def __init__(self, count: int, cell_size: float):
        self.count = count
        self.cell_size = cell_size
        self.period = period_for(count)
        cells = self.period**3
        self.first = ti.ndarray(ti.i32, cells)
        self.last = ti.ndarray(ti.i32, cells)
        self.order = ti.ndarray(ti.i32, max(count, 1))
        self._cell = ti.ndarray(ti.i32, max(count, 1))
        self._chunks = ti.ndarray(ti.i32, -(-cells // SCAN_CHUNK))

    def sort(self, position: ti.Ndarray) -> ti.Ndarray:
        """Find the order of particles by cell; stable, so that the same positions give the same order."""
        _sort(
            self.count,
            1.0 / self.cell_size,
            self.period,
            position,
            self._cell,
            self._chunks,
            self.first,
            self.last,
            self.order,
        )
        return self.order

    @property
    def bytes(self) -> int:
        return 4 * (2 * self.period**3 + 2 * self.count)


class NeighborList:
    """Indices of the neighbours of `count` particles, `capacity` at most each."""

    def __init__(self, count: int, capacity: int):
        self.capacity = capacity
        self.count = count
        self.size = ti.ndarray(ti.i32, max(count, 1))
        self.index = ti.ndarray(ti.i32, (max(count, 1), capacity))

    def build(self, position: ti.Ndarray, cells: Cells, other: ti.Ndarray) -> None:
        """List the `other` particles, sorted into `cells`, in the support of each particle."""
        while True:
            longest = _build(
                self.count,
                cells.cell_size,
                position,
                cells.period,
                cells.first,
                cells.last,
                other,
                self.capacity,
                self.size,
                self.index,
            )
            if longest < self.capacity:
                return
            self.capacity = -(-(longest + 1) * 5 // 4 // 16) * 16
            self.index = ti.ndarray(ti.i32, (max(self.count, 1), self.capacity))

    @property
    def bytes(self) -> int:
        return 4 * self.count * (self.capacity + 1)


class StaticGrid:
    """Cells of points that never move: sorted once, on the host.

    points: positions [m], shape [n, 3]; `order` brings them into the order of the cells.
    """

    def __init__(self, points: np.ndarray, cell_size: float):
        self.cell_size = cell_size
        self.period = period_for(len(points))
        inverse = np.float32(1.0 / cell_size)
        cell = np.floor(points.astype(np.float32) * inverse).astype(np.int64) & (self.period - 1)
        key = (cell[:, 2] * self.period + cell[:, 1]) * self.period + cell[:, 0]
        self.order = np.argsort(key, kind="stable")
        cells = np.arange(self.period**3)
        self.first = ti.ndarray(ti.i32, len(cells))
        self.last = ti.ndarray(ti.i32, len(cells))
        self.first.from_numpy(np.searchsorted(key[self.order], cells, side="left").astype(np.int32))
        self.last.from_numpy(np.searchsorted(key[self.order], cells, side="right").astype(np.int32))

    @property
    def bytes(self) -> int:
        return 8 * self.period**3


@ti.func
def row_of(y: ti.i32, z: ti.i32, period: ti.i32) -> ti.i32:
    """Number of the first cell in the row at (y, z)."""
    return ((z & (period - 1)) * period + (y & (period - 1))) * period


@ti.func
def cell_at(point, inverse_cell_size: ti.f32):
    return ti.floor(point * inverse_cell_size, ti.i32)


@ti.kernel
def _sort(
    count: ti.i32,
    inverse_cell_size: ti.f32,
    period: ti.i32,
    position: Vec4Array,
    cell: IntArray,
    chunks: IntArray,
    first: IntArray,
    last: IntArray,
    order: IntArray,
):
    """Counting sort by cell; one kernel, since its launch costs more than most of its loops.

    `last` counts the particles of a cell, then is where its next one goes, and at last its end.
    """
    for c in range(last.shape[0]):
        last[c] = 0
    for i in range(count):
        at = cell_at(position[i].xyz, inverse_cell_size)
        c = row_of(at.y, at.z, period) + (at.x & (period - 1))
        cell[i] = c
        ti.atomic_add(last[c], 1)
    for k in range(chunks.shape[0]):
        s = 0
        for c in range(k * SCAN_CHUNK, ti.min((k + 1) * SCAN_CHUNK, last.shape[0])):
            s += last[c]
        chunks[k] = s
    ti.loop_config(serialize=True)
    for _ in range(1):
        s = 0
        for k in range(chunks.shape[0]):
            here = chunks[k]
            chunks[k] = s
            s += here
    for k in range(chunks.shape[0]):
        s = chunks[k]
        for c in range(k * SCAN_CHUNK, ti.min((k + 1) * SCAN_CHUNK, last.shape[0])):
            here = last[c]
            first[c] = s
            last[c] = s
            s += here
    for i in range(count):
        order[ti.atomic_add(last[cell[i]], 1)] = i
    # Atomics place the particles of a cell in no particular order: sort them by their former index.
    for c in range(first.shape[0]):
        for k in range(first[c] + 1, last[c]):
            value = order[k]
            slot = k - 1
            while slot >= first[c] and order[slot] > value:
                order[slot + 1] = order[slot]
                slot -= 1
            order[slot + 1] = value


@ti.kernel
def _build(
    count: ti.i32,
    support_radius: ti.f32,
    position: Vec4Array,
    period: ti.i32,
    first: IntArray,
    last: IntArray,
    other: Vec4Array,
    capacity: ti.i32,
    size: IntArray,
    index: IntTable,
) -> ti.i32:
    """List for every particle the `other` particles in its support; returns the room that was needed.

    Every candidate is stored in the next slot, and a hit moves on to the one after: a branch less. So there has to
    be room for all candidates of a row, else the row is left out, and the list has to grow and be built again.
    """
    longest = 0
    for i in range(count):
        x = position[i].xyz
        at = cell_at(x, 1.0 / support_radius)
        found, needed = 0, 0
        left = (at.x - 1) & (period - 1)
        right = (at.x + 1) & (period - 1)
        pieces = ti.select(left < right, 1, 3)
        for dy, dz in ti.static(ROWS):
            row = row_of(at.y + dy, at.z + dz, period)
            for piece in range(pieces):
                begin = row + ti.select(pieces == 1, left, (at.x - 1 + piece) & (period - 1))
                end = ti.select(pieces == 1, row + right, begin)
                needed = ti.max(needed, found + last[end] - first[begin])
                if needed < capacity:
                    for j in range(first[begin], last[end]):
                        d = x - other[j].xyz
                        index[i, found] = j
                        found += ti.cast(d.dot(d) < support_radius * support_radius, ti.i32)
        size[i] = found
        ti.atomic_max(longest, needed)
    return longest
