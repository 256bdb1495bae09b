"""Particles next to solids, moved until none is denser than fluid at rest.

Where a lattice is cut by a surface its outermost particles are anywhere from 0 to 1 spacing off it. They are brought
half a spacing off, and then all nearby are moved until the density rho_i = sum_j m W_ij and what solids add is nowhere
above rho_0: by lambda_i = -max(rho_i / rho_0 - 1, 0) / sum_j |grad_j|^2 along the gradients of the densities, dx_i =
sum_j (lambda_i + lambda_j) grad W_ij (Macklin & Müller 2013, eq. 8 to 12). All solids count as plane walls do, by the
distance alone. The kernel's support is two spacings here, whatever the solver's: a longer one sees less of disorder.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from sim.fluid.boundary.calibration import calibrate_wall
from sim.fluid.kernel import (
    cubic_host,
    cubic_slope_host,
    halfspace_area_host,
    halfspace_volume_host,
    lattice,
    particle_mass,
)
from sim.geometry.distance.clearance import Gap, Gaps

SUPPORT = 2.0
"""Support radius over the spacing."""
ROUNDS = 120
LOOKS = 4
"""Rounds after which neighbours and gaps are found anew; in between surfaces are taken for planes."""
STRAYED = 0.1
"""Gaps are found anew for points that have moved this many spacings since."""
DENSEST = 1.002
"""Where no density is above this one [rho_0], no more is moved."""
ORDERING = 10
"""Rounds at the end in which points that are too near to one another part, and densities do not count."""
MOMENTUM = 0.5
"""Share of the last round's way that is gone again: an excess then spreads in fewer rounds."""
LONGEST = 0.1
"""Longest way of a point in a round, in spacings: less than what keeps it from passing through a surface."""
APART = 0.9
"""Points nearer than this many spacings are moved apart whatever their density is."""
RATE = 0.4
"""Share of that which is done in a round: a point has many neighbours."""
JITTER = 0.02
"""How far points are moved at first, in spacings: rows of a lattice would be pushed along straight lines only."""


def settle(
    points: np.ndarray,
    moves: np.ndarray,
    others: np.ndarray,
    own: Gaps,
    solids: Gaps,
    spacing: float,
    clearance: tuple[float, float],
) -> np.ndarray:
    """Points [m], shape [n, 3], of which those that move, shape [n], were moved off surfaces and one another.

    `others`, shape [m, 3], are particles that stay. Points keep inside of the `own` surface of their body where
    `solids` leave room for that: they are brought to the first `clearance` [m] off both, and end at the second or more.
    """
    points = points.copy()
    movable = np.flatnonzero(moves)
    if not len(movable):
        return points
    still = np.concatenate((points[~moves], others))
    if len(still):
        nearest, _ = cKDTree(points[movable]).query(still, distance_upper_bound=2 * SUPPORT * spacing)
        still = still[np.isfinite(nearest)]
    points[movable] = _Settling(points[movable], still, own, solids, spacing, clearance).settled()
    return points


class _Settling:
    """Points that move, which are the first of `place`, others that stay, and the surfaces around the former."""

    def __init__(
        self,
        place: np.ndarray,
        still: np.ndarray,
        own: Gaps,
        solids: Gaps,
        spacing: float,
        clearance: tuple[float, float],
    ):
        self.count, self.spacing = len(place), spacing
        self.place = np.concatenate((place, still))
        self.own, self.solids = own, solids
        self.wanted, self.least = clearance
        self.h = SUPPORT * spacing
        self.mass = particle_mass(spacing, self.h, 1.0)
        self.wall = calibrate_wall(spacing, self.h)
        at = lattice(spacing, self.h)
        slopes = self._slopes(np.linalg.norm(at, axis=1))[:, None] * at
        self.stiffness = float((slopes**2).sum())
        """Sum of |m grad W / rho_0|^2 in a lattice [1/m^2]."""

    def settled(self) -> np.ndarray:
        """Where the points that move come to [m], shape [n, 3]."""
        free = self.place[: self.count]
        self.seen = free.copy()
        self.found = [list(gaps(free, self.h)) for gaps in (self.own, self.solids)]
        self._keep_off(self.wanted)
        free += JITTER * self.spacing * np.random.default_rng(0).uniform(-1.0, 1.0, free.shape)
        way = np.zeros_like(free)
        for turn in range(ROUNDS + ORDERING):
            if turn % LOOKS == 0:
                self._look()
            push, densest = self._push(by_density=turn < ROUNDS)
            if densest < DENSEST:
                break
            before = free.copy()
            free += bounded(push[: self.count] + MOMENTUM * way, LONGEST * self.spacing)
            self._keep_off(self.least)
            way = free - before
        return self._kept_off(free)

    def _look(self) -> None:
        """Find neighbours, and the gaps of points that have strayed."""
        pairs = cKDTree(self.place).query_pairs(1.1 * self.h, output_type="ndarray")
        self.pairs = pairs.T
        free = self.place[: self.count]
        strayed = np.linalg.norm(free - self.seen, axis=1) > STRAYED * self.spacing
        rows = np.flatnonzero(strayed)
        if len(rows):
            self.seen[rows] = free[rows]
            self.found = [
                [
                    old.where(~strayed).joined(Gap(rows[new.rows], new.width, new.away))
                    for old, new in zip(kind, gaps(free[rows], self.h), strict=True)
                ]
                for kind, gaps in zip(self.found, (self.own, self.solids), strict=True)
            ]

    def _width(self, gap: Gap) -> np.ndarray:
        """The gaps now [m], since points have moved on."""
        way = self.place[gap.rows] - self.seen[gap.rows]
        return gap.width + np.einsum("ij,ij->i", way, gap.away)

    def _keep_off(self, clearance: float) -> None:
        """Move points `clearance` [m] off surfaces, solids last since they count most."""
        for gap in (*self.found[0], *self.found[1]):
            short = np.maximum(clearance - self._width(gap), 0.0)
            self.place[gap.rows] += short[:, None] * gap.away

    def _push(self, *, by_density: bool) -> tuple[np.ndarray, float]:
        """Where points are pushed [m], shape [n, 3], and the greatest density [rho_0]."""
        count, (a, b) = len(self.place), self.pairs
        apart = self.place[a] - self.place[b]
        r = np.linalg.norm(apart, axis=1)
        weights = self.mass * cubic_host(r, self.h)
        density = self.mass * float(cubic_host(0.0, self.h)) + np.bincount(a, weights, count)
        share, slope = self._of_solids()
        density += np.bincount(b, weights, count) + share
        excess = np.maximum(density - 1.0, 0.0)
        way = self._off_each_other(a, b, apart, r)
        if not by_density:
            return way, float(density.max())
        active = (excess[a] + excess[b] > 0) & (r < self.h)
        a, b, slopes = a[active], b[active], self._slopes(r[active])[:, None] * apart[active]
        slope += gathered(a, slopes, count) - gathered(b, slopes, count)
        factor = -excess / (self.stiffness + np.einsum("ij,ij->i", slope, slope))
        # Each point follows the gradient of its own density, and those of its neighbours.
        # Macklin & Müller 2013, eq. 12
        way += factor[:, None] * slope
        way += gathered(a, factor[b, None] * slopes, count) - gathered(b, factor[a, None] * slopes, count)
        return way, float(density.max())

    def _off_each_other(self, a: np.ndarray, b: np.ndarray, apart: np.ndarray, r: np.ndarray) -> np.ndarray:
        """Half of what pairs lack to being APART, along the lines between them."""
        close = np.flatnonzero(r < APART * self.spacing)
        lack = APART * self.spacing / np.maximum(r[close], 1e-9 * self.spacing) - 1.0
        push = RATE / 2 * lack[:, None] * apart[close]
        return gathered(a[close], push, len(self.place)) - gathered(b[close], push, len(self.place))

    def _of_solids(self) -> tuple[np.ndarray, np.ndarray]:
        """What solids add to the densities, shape [n], and the gradients of that [1/m], shape [n, 3]: as
        `sim.fluid.boundary.face_sums.place`."""
        count, overlap = len(self.place), self.wall.overlap
        share, void = np.zeros(count), np.ones(count)
        gradient, void_gradient = np.zeros((count, 3)), np.zeros((count, 3))
        setback = self.wall.distance - self.spacing / 2
        for gap in self.found[1]:
            q = np.clip((self._width(gap) + setback) / self.h, 0.0, 1.0)
            rows, own = gap.rows, self.wall.weight * halfspace_volume_host(q)
            slope = -(self.wall.weight * halfspace_area_host(q) / self.h)[:, None] * gap.away
            left = overlap / (overlap + own)
            share[rows] += own - (1.0 - left)
            gradient[rows] += (1.0 - left**2 / overlap)[:, None] * slope
            loss = (void[rows] * left**2 / overlap)[:, None] * slope
            void_gradient[rows] = left[:, None] * void_gradient[rows] - loss
            void[rows] *= left
        return share + 1.0 - void, gradient - void_gradient

    def _slopes(self, r: np.ndarray) -> np.ndarray:
        return self.mass * cubic_slope_host(r, self.h)

    def _kept_off(self, points: np.ndarray) -> np.ndarray:
        """The points at the least clearance exactly, as far as one surface does not ask for the contrary of another."""
        margin = 1e-3 * self.least
        rest = np.arange(len(points))
        for _ in range(LOOKS):
            short = np.zeros(len(rest), dtype=bool)
            for gaps in (self.own, self.solids):
                for gap in gaps(points[rest], self.least + margin):
                    lack = self.least + margin - gap.width
                    points[rest[gap.rows]] += np.maximum(lack, 0.0)[:, None] * gap.away
                    short[gap.rows] |= lack > margin / 2
            rest = rest[short]
            if not len(rest):
                break
        return points


def bounded(way: np.ndarray, longest: float) -> np.ndarray:
    """Ways, shape [n, 3], of which none is longer than `longest`."""
    length = np.linalg.norm(way, axis=1, keepdims=True)
    return way * np.minimum(1.0, longest / np.maximum(length, 1e-300))


def gathered(rows: np.ndarray, vectors: np.ndarray, count: int) -> np.ndarray:
    """Sums of vectors, shape [n, 3], by the row that they belong to; shape [count, 3]."""
    return np.stack([np.bincount(rows, weights=vectors[:, axis], minlength=count) for axis in range(3)], axis=1).astype(
        float
    )
