"""Neighbour search by compact spatial hashing.

Space is divided into cells: as long as the search radius along y and z, a quarter of it along x. They are numbered
periodically: cell (x, y, z) has the same number as its images a period away, so that memory follows the number of
particles and no domain bounds the scene. Far images share a cell and drop out by their distance.
Within a period the numbering is linear with x running fastest, so that the cells of a row lie together in memory, and
the fine division along x lets a search skip the ends of the rows that its sphere does not reach.
"""

from typing import Any, Self

from scene.settings import Refused
from sim.device.argument_packs import argpack
from sim.device.arrays import GROWTH, IntArray, Vec4Array, real, vec3
from sim.device.compiler import ti

SLICES = 4
"""Cells along x in one search radius."""
SCAN_CHUNK = 1024
LANES = 8
"""Lists are padded to a multiple of this with the particle itself, so that loops over them run in full vectors."""
LARGEST = 2**31 - 1
"""Entries of all lists together: they are numbered by 32 bits."""
ROWS = tuple((dy, dz) for dz in (-1, 0, 1) for dy in (-1, 0, 1))
"""Rows of cells around a particle's own, nearest in memory first."""
SLACK = 1e-3
"""Share of the radius by which the reach along a row is too long rather than too short, for rounding."""

PAGE = 64
"""So many lists lie one behind another and share their room, so that passes over all pairs read memory in a row. On a
GPU each has room of its own, since a thread of its own fills it."""

Neighbors: Any = argpack(begin=IntArray, size=IntArray, index=IntArray)
"""Of each particle, where its list begins and how many neighbours it has; and the lists."""


@ti.func
def padded(size: ti.i32) -> ti.i32:
    """How far to run through a padded list of this size."""
    return (size + (LANES - 1)) & ~(LANES - 1)


@ti.func
def itself(size: ti.i32) -> ti.i32:
    """How often a particle has to be counted beside its padded list, to be counted once in all."""
    return 1 - (padded(size) - size)


def periods_for(count: int) -> tuple[int, int, int]:
    """Search radii along x, y and z in a period: powers of two, one to two cubes a particle for room to splash."""
    period = [8, 8, 8]
    axis = 0
    while period[0] * period[1] * period[2] < count:
        period[(0, 2, 1)[axis % 3]] *= 2
        axis += 1
    return period[0], period[1], period[2]


class HashGrid:
    """Points sorted by cell: those of cell c are start[c] up to, without, start[c + 1]."""

    def __init__(self, count: int, radius: float):
        self.radius = radius
        self._capacity = 0
        self.periods = (0, 0, 0)
        self.fit(count)

    def fit(self, count: int) -> bool:
        """Choose the period for this many points; the order of points depends on it. Returns whether it is another:
        then nothing is sorted any more."""
        if self.periods == periods_for(count):
            return False
        self.periods = periods_for(count)
        self._cells = self.periods[0] * SLICES * self.periods[1] * self.periods[2]
        self.start = ti.ndarray(ti.i32, self._cells + 2)
        self._chunks = ti.ndarray(ti.i32, -(-(self._cells + 2) // SCAN_CHUNK))
        return True

    def sort(self, position: ti.Ndarray, count: int) -> ti.Ndarray:
        """Find the order of points by cell; stable, so that the same positions give the same order."""
        if count > self._capacity:
            self._capacity = int(GROWTH * count)
            self.order = ti.ndarray(ti.i32, self._capacity)
            self._cell = ti.ndarray(ti.i32, self._capacity)
        if count:
            _sort(
                count,
                self.radius,
                *self.periods,
                self._cells,
                position,
                self._cell,
                self._chunks,
                self.start,
                self.order,
            )
        return self.order

    @property
    def bytes(self) -> int:
        """Memory of where cells begin, and of the order of points [bytes]."""
        return 4 * (self._cells + 2 * self._capacity)


class NeighborList:
    """Indices of the neighbours of particles: the k-th of particle i is index[begin[i] + k], for k below size[i].

    expected: neighbours of a particle, for the room to begin with. Raises Refused where lists become too long to number
    their entries.
    """

    def __init__(self, expected: int):
        self._page = PAGE if ti.cfg.arch == ti.cpu else 1
        self._room = self._page * (expected + LANES)
        self._rows = 0
        self._allocate(1)

    def _allocate(self, rows: int) -> None:
        entries = -(-rows // self._page) * self._room
        if entries > LARGEST:
            raise Refused(f"{rows:,} particles have more neighbours than can be listed", remedy="use fewer particles")
        self._rows = rows
        self.begin, self.size = ti.ndarray(ti.i32, rows), ti.ndarray(ti.i32, rows)
        self.index = ti.ndarray(ti.i32, entries)
        self.lists = Neighbors(self.begin, self.size, self.index)

    def build(self, position: ti.Ndarray, count: int, cells: HashGrid, other: ti.Ndarray, *, same: bool) -> None:
        """List the `other` points, sorted into `cells`, within their radius of each particle.

        `same`: the others are the particles themselves; none is in its own list, but pads it.
        """
        self.reserve(count)
        while count:
            longest = _build(
                count,
                self._page,
                self._room,
                cells.radius,
                position,
                *cells.periods,
                cells.start,
                other,
                same,
                self.begin,
                self.size,
                self.index,
            )
            if longest < self._room:
                return
            self._room = (longest * 9 // 8 // LANES + 2) * LANES
            self._allocate(self._rows)

    def reserve(self, count: int) -> None:
        """Make room for the lists of `count` particles; where there was less, none is kept."""
        if count > self._rows:
            self._allocate(int(GROWTH * count) if self._rows > 1 else count)

    def match(self, others: Self, count: int) -> None:
        """Make room for lists of `count` particles that begin where others do, and are no longer."""
        if self._room != others._room or count > self._rows:
            self._room = others._room
            self._allocate(others._rows)

    def clear(self, count: int) -> None:
        """Hold lists of `count` points that have no neighbours."""
        self.reserve(count)
        self.size.fill(0)

    def forget(self, count: int) -> None:
        """Hold rows for `count` points of whose neighbours nothing is known but that they may have some."""
        self.reserve(count)
        self.size.fill(1)

    @property
    def bytes(self) -> int:
        """Memory of the indices, and of where and how many there are of each particle [bytes]."""
        return 4 * (self.index.shape[0] + 2 * self._rows)


@ti.kernel
def _sort(
    count: ti.i32,
    radius: real,
    px: ti.i32,
    py: ti.i32,
    pz: ti.i32,
    cells: ti.i32,
    position: Vec4Array,
    cell: IntArray,
    chunks: IntArray,
    start: IntArray,
    order: IntArray,
):
    """Counting sort by cell; one kernel, since its launch costs more than most of its loops.

    `start` counts the points of cell c at c + 2; summed up, c + 1 is where the next point of cell c goes, and so
    at last its end and the start of the cell after.
    """
    for c in range(cells + 2):
        start[c] = 0
    for i in range(count):
        u = position[i].xyz / radius
        at = ti.floor(vec3(u.x * SLICES, u.y, u.z), ti.i32)
        c = ((at.z & (pz - 1)) * py + (at.y & (py - 1))) * px * SLICES + (at.x & (px * SLICES - 1))
        cell[i] = c
        ti.atomic_add(start[c + 2], 1)
    for k in range(chunks.shape[0]):
        s = 0
        for c in range(k * SCAN_CHUNK, ti.min((k + 1) * SCAN_CHUNK, cells + 2)):
            s += start[c]
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
        for c in range(k * SCAN_CHUNK, ti.min((k + 1) * SCAN_CHUNK, cells + 2)):
            s += start[c]
            start[c] = s
    for i in range(count):
        order[ti.atomic_add(start[cell[i] + 1], 1)] = i
    # Atomics place the points of a cell in no particular order: sort them by their former index.
    for c in range(cells):
        for k in range(start[c] + 1, start[c + 1]):
            value = order[k]
            slot = k - 1
            while slot >= start[c] and order[slot] > value:
                order[slot + 1] = order[slot]
                slot -= 1
            order[slot + 1] = value


@ti.kernel
def _build(
    count: ti.i32,
    page: ti.i32,
    room: ti.i32,
    radius: real,
    position: Vec4Array,
    px: ti.i32,
    py: ti.i32,
    pz: ti.i32,
    start: IntArray,
    other: Vec4Array,
    same: ti.template(),
    begin: IntArray,
    size: IntArray,
    index: IntArray,
) -> ti.i32:
    """List for every particle the `other` points within the radius; returns the room that the longest page needs. The
    last entry of a page's room is for what finds none.

    Every candidate is stored in the next slot, and a hit moves on to the one after: a branch less.
    """
    longest = 0
    for p in range((count + page - 1) // page):
        bottom, top = p * room, (p + 1) * room - 1
        slot = bottom
        for i in range(p * page, ti.min((p + 1) * page, count)):
            x = position[i].xyz
            u = x / radius
            whole = ti.floor(u)
            at = ti.cast(whole, ti.i32)
            inside = u - whole
            first = slot
            for dy, dz in ti.static(ROWS):
                across = row_distance(inside.y, dy) ** 2 + row_distance(inside.z, dz) ** 2
                if across < 1.0 + SLACK:
                    reach = ti.sqrt(1.0 + SLACK - across)
                    low, high = ti.floor((u.x - reach) * SLICES, ti.i32), ti.floor((u.x + reach) * SLICES, ti.i32)
                    left, right = low & (px * SLICES - 1), high & (px * SLICES - 1)
                    row = (((at.z + dz) & (pz - 1)) * py + ((at.y + dy) & (py - 1))) * px * SLICES
                    wraps = ti.cast(left > right, ti.i32)
                    for piece in range(1 + wraps):
                        head = start[row + ti.select(piece == 0, left, 0)]
                        tail = start[row + ti.select(piece == wraps, right, px * SLICES - 1) + 1]
                        for j in range(head, tail):
                            d = x - other[j].xyz
                            index[ti.min(slot, top)] = j
                            near = ti.cast(d.dot(d) < radius * radius, ti.i32)
                            if ti.static(same and dy == 0 and dz == 0):
                                near &= ti.cast(j != i, ti.i32)
                            slot += near
            begin[i] = first
            size[i] = slot - first
            if ti.static(same):
                end = first + padded(slot - first)
                for k in range(slot, end):
                    index[ti.min(k, top)] = i
                slot = end
        ti.atomic_max(longest, slot - bottom)
    return longest


@ti.func
def row_distance(inside: real, step: ti.template()):
    """Distance to the row of cells `step` further on, over the cell's length."""
    distance = ti.cast(0.0, real)
    if ti.static(step < 0):
        distance = inside
    if ti.static(step > 0):
        distance = 1.0 - inside
    return distance
