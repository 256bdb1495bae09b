"""Where the particles of a fluid body begin: as many as the volume holds that solids and other fluid leave of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial import cKDTree

from sim.fluid.kernel import cubic_host, cubic_slope_host, halfspace_volume_host, particle_mass
from sim.fluid.seeding.settling import SUPPORT, settle
from sim.geometry.distance.clearance import Gap
from sim.geometry.filling import EDGE_TOLERANCE, outermost
from sim.geometry.solids import Solid
from sim.geometry.thinning import first_come

START_CLEARANCE = 0.45
"""Fluid starts at least this many spacings off every solid."""
HALF = 0.5
"""Where points are moved, they are brought this many spacings off solids, which is where a lattice has them."""
OVERLAP = 0.9
"""Fluid that keeps this many spacings off the fluid that is there stays where it is."""
BARELY = 0.3
"""Points that would be nearer than this many spacings to a second surface are better left out."""
CLOSEST = 0.7
"""Points that could not be moved this many spacings apart have no room."""
NEAR = 5.0
"""Points within this many spacings of a surface may be moved."""
CUTS = 2
"""How often cells next to solids are halved to find the volume: walls of a quarter spacing are seen."""
SAME = 0.1
"""Surfaces of a body and of a solid that are nearer than this many edges of a cell are one, as far as cuts go."""
EIGHTH = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
"""Centres of the eight parts of a cell around its own, in edges of a part."""


class Room(Protocol):
    """What solids and sheets leave for fluid."""

    def free(self, points: np.ndarray, clearance: float) -> np.ndarray:
        """Whether points [m], shape [n, 3], are `clearance` [m] off everything; shape [n]."""

    def gaps(self, points: np.ndarray, reach: float) -> Sequence[Gap]:
        """The gaps of points [m], shape [n, 3], to everything that is nearer than `reach` [m] or around them."""

    def faces(self, points: np.ndarray, reach: float) -> Sequence[Gap]:
        """The same, and to every face where those of one solid meet in a hollow edge."""


@dataclass(frozen=True)
class Seed:
    """The particles of a fluid body: places [m], shape [n, 3]; volume: what is free of the shape [m^3]; number: of
    particles that this volume holds, of which some may have found no room."""

    points: np.ndarray
    volume: float
    number: int


def seed(solid: Solid, filled: np.ndarray, spacing: float, room: Room, present: np.ndarray) -> Seed:
    """Particles of mass rho0 spacing^3 for what is free of a shape that `filled`, shape [n, 3], fills alone.

    `present`: the fluid that is there [m], shape [m, 3]. Where nothing is in the way the particles are those of
    `filled`. Otherwise those that are deepest in solids and other fluid are left out until the number is that of
    the free volume, and the others near surfaces are pushed apart and off these.
    """
    present = _around(solid, present, spacing)
    volume = solid.volume - _taken_by_solids(solid, spacing, room) - _taken_by_fluid(solid, spacing, present)
    number = min(max(round(volume / spacing**3), 0), len(filled))
    solids = room.gaps(filled, NEAR * spacing)
    closest = _Closest.of(solids, len(filled))
    apart = cKDTree(present).query(filled)[0] if len(present) else np.full(len(filled), np.inf)
    clear = (closest.width > START_CLEARANCE * spacing) & (apart > OVERLAP * spacing)
    if clear.all() and len(filled) - number <= max(1, EDGE_TOLERANCE * len(filled)):
        return Seed(filled, volume, len(filled))
    closest = _Closest.of([*solids, _to_fluid(present, filled, spacing)], len(filled))
    kept = _with_most_room(solid, filled, closest, room, number, spacing)
    points = filled[kept]
    if clear[kept].all():
        return Seed(points, volume, number)
    moves = (closest.width < NEAR * spacing) | (apart < NEAR * spacing)

    def own(places: np.ndarray, reach: float) -> list[Gap]:
        return [_to_own_surface(solid, places, reach), _to_fluid(present, places, spacing)]

    clearance = HALF * spacing, START_CLEARANCE * spacing
    points = settle(points, moves[kept], present, own, room.faces, spacing, clearance)
    fits = ~moves[kept]
    fits[~fits] = room.free(points[~fits], START_CLEARANCE * spacing)
    if len(present):
        fits &= cKDTree(present).query(points)[0] > CLOSEST * spacing
    points = points[fits]
    return Seed(points[first_come(points, min(CLOSEST * spacing, 0.999 * _closest_pair(filled)))], volume, number)


def _closest_pair(points: np.ndarray) -> float:
    """The shortest distance [m] of two points; infinite for one."""
    return float(cKDTree(points).query(points, k=2)[0][:, 1].min())


@dataclass(frozen=True)
class _Closest:
    """The narrowest gap of each point [m], shape [n], infinite where none is near, and where it grows, shape [n, 3]."""

    width: np.ndarray
    away: np.ndarray

    @classmethod
    def of(cls, gaps: Sequence[Gap], count: int) -> _Closest:
        width, away = np.full(count, np.inf), np.zeros((count, 3))
        for gap in gaps:
            closer = gap.width < width[gap.rows]
            rows = gap.rows[closer]
            width[rows], away[rows] = gap.width[closer], gap.away[closer]
        return cls(width, away)


def _with_most_room(
    solid: Solid, points: np.ndarray, closest: _Closest, room: Room, number: int, spacing: float
) -> np.ndarray:
    """The indices of the `number` points that are least in the way of solids and other fluid, ascending.

    Points that could not be moved off one surface without leaving the shape, as those behind a thin wall, or coming
    near to another surface, come last.
    """
    depth = np.minimum(closest.width, NEAR * spacing)
    rows = np.flatnonzero(np.abs(closest.width) < HALF * spacing)
    landing = points[rows] + (HALF * spacing - closest.width[rows])[:, None] * closest.away[rows]
    bad = solid.signed_distance(landing) > 0
    bad |= _Closest.of(room.gaps(landing, spacing), len(rows)).width < BARELY * spacing
    depth[rows[bad]] -= 2 * NEAR * spacing
    return np.delete(np.arange(len(points)), outermost(depth, len(points) - number, spacing))


def _around(solid: Solid, present: np.ndarray, spacing: float) -> np.ndarray:
    """Those of the points in and near the shape."""
    low, high = solid.bounds
    return present[np.all((present > low - NEAR * spacing) & (present < high + NEAR * spacing), axis=1)]


def _to_own_surface(solid: Solid, points: np.ndarray, reach: float) -> Gap:
    distance, slope = solid.distance_and_slope(points, reach)
    rows = np.flatnonzero(-distance < reach)
    return Gap(rows, -distance[rows], -slope[rows])


def _to_fluid(present: np.ndarray, points: np.ndarray, spacing: float) -> Gap:
    """The gap to the surface of the fluid that is there, by its share of the density: half of it on the surface."""
    h = SUPPORT * spacing
    found = cKDTree(points).sparse_distance_matrix(cKDTree(present), h, output_type="coo_matrix")
    order = np.lexsort((found.col, found.row))
    at, r = found.row[order], found.data[order]
    apart = points[at] - present[found.col[order]]
    share = particle_mass(spacing, h, 1.0) * np.bincount(at, cubic_host(r, h), len(points))
    slopes = -cubic_slope_host(r, h)[:, None] * apart
    away = np.stack([np.bincount(at, slopes[:, axis], len(points)) for axis in range(3)], axis=1)
    steepness = np.linalg.norm(away, axis=1)
    rows = np.flatnonzero(share > 0)
    q = np.linspace(1.0, -1.0, 401)
    width = h * np.interp(share[rows], halfspace_volume_host(q), q)
    return Gap(rows, width, away[rows] / np.maximum(steepness[rows], 1e-300)[:, None])


def _taken_by_fluid(solid: Solid, spacing: float, present: np.ndarray) -> float:
    """Volume [m^3] in the shape of the fluid that is there."""
    return spacing**3 * float(_share_inside(solid.signed_distance(present), spacing).sum())


def _taken_by_solids(solid: Solid, spacing: float, room: Room) -> float:
    """Volume [m^3] of the shape that solids take, by cells that are cut where surfaces pass."""
    low, high = solid.bounds
    counts = np.ceil((high - low) / spacing - EDGE_TOLERANCE).astype(int) + 1
    origin = (low + high) / 2 - (counts - 1) / 2 * spacing
    cells = origin + spacing * np.argwhere(np.ones(counts, dtype=bool))
    corner = np.sqrt(3) / 2 * spacing
    width = _Closest.of(room.gaps(cells, corner), len(cells)).width
    near = width < corner
    cells, width = cells[near], width[near]
    distance, _ = solid.distance_and_slope(cells, corner)
    whole = (distance < -corner) & (width < -corner)
    taken = np.count_nonzero(whole) * spacing**3
    cells, step = cells[(distance < corner) & ~whole], spacing
    for _ in range(CUTS):
        step /= 2
        cells = (cells[:, None] + step * EIGHTH).reshape(-1, 3)
        width = np.minimum(_Closest.of(room.gaps(cells, step), len(cells)).width, step)
        distance = np.clip(solid.distance_and_slope(cells, step)[0], -step, step)
        shares = _share_inside(distance, step) - _share_inside(np.maximum(distance, -width), step)
        # Where two surfaces pass through a cell, and are not the same, it is cut again.
        cut = (np.minimum(np.abs(distance), np.abs(width)) < step / 2) & (np.abs(distance + width) > SAME * step)
        taken += float(shares[~cut].sum()) * step**3
        cells = cells[cut]
    return taken + float(shares[cut].sum()) * step**3


def _share_inside(distance: np.ndarray, step: float) -> np.ndarray:
    """The share of a cube of edge `step` [m] that lies inside a surface at this signed distance [m] of its centre."""
    return np.clip(0.5 - distance / step, 0.0, 1.0)
