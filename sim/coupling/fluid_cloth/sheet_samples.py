"""Boundary samples of sheets: what is thin, moves, bends and stretches.

Each place on a sheet has two samples, one for the fluid on either side. It lies behind the sheet as seen from there, as
deep as samples of solids do, so that fluid comes to rest on the sheet itself; and particles on the other side do not
know of it. Its volume follows the area that it stands for. Forces on samples are spread over the corners of their
triangle by barycentric weights, as positions are found from these (Akinci et al. 2013b): no momentum is lost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.cloth.fabric.arrays import incidence, integers, numbers, vectors
from sim.coupling.fluid_cloth import sheet_sums
from sim.device.compiler import ti
from sim.fluid.boundary.calibration import sample_depth, sample_volume, sample_weight
from sim.fluid.boundary.one_sided_samples import OneSidedSamples
from sim.fluid.forces.terms import BY_SOLIDS, Terms
from sim.fluid.system import FluidSystem
from sim.neighbors.spatial_hash import NeighborList

STRETCH = 1.3
"""Samples are laid anew when a sheet has stretched by this factor since."""


@dataclass(frozen=True)
class Pattern:
    """Places on triangles: corners, shape [n, 3], their weights, shape [n, 3], and the share of the triangle's area;
    cuts: of the sides of triangles, shape [t]."""

    cuts: np.ndarray
    corners: np.ndarray
    weights: np.ndarray
    share: np.ndarray

    @classmethod
    def of(cls, triangles: np.ndarray, cuts: np.ndarray) -> Pattern:
        """The centres of the like triangles into which `cuts`, shape [t], of each side divide each."""
        corners, weights, share = [np.zeros((0, 3), int)], [np.zeros((0, 3))], [np.zeros(0)]
        for number in np.unique(cuts):
            own = triangles[cuts == number]
            places = _centres(int(number))
            corners.append(np.repeat(own, len(places), axis=0))
            weights.append(np.tile(places, (len(own), 1)))
            share.append(np.full(len(own) * len(places), 1.0 / len(places)))
        return cls(cuts, np.concatenate(corners), np.concatenate(weights), np.concatenate(share))


def find_cuts(triangles: np.ndarray, placed: np.ndarray, now: np.ndarray, spacing: float) -> np.ndarray:
    """Into how many the sides of triangles, shape [t, 3], are to be divided, for samples no more than `spacing` [m]
    apart until they have stretched further by STRETCH; shape [t]. `placed`, `now`: points [m], shape [n, 3].

    The stretch counts in powers of STRETCH, so that it is seldom another one.
    """
    at_rest, present = (
        np.linalg.norm(points[triangles] - points[np.roll(triangles, 1, axis=1)], axis=2) for points in (placed, now)
    )
    grown = max(float((present / at_rest).max(initial=1.0)), 1.0)
    level = np.floor(np.log(grown) / np.log(STRETCH) + 1e-9)
    return np.ceil(at_rest.max(axis=1) * STRETCH ** (level + 1) / spacing).astype(int)


def _centres(number: int) -> np.ndarray:
    """Barycentric weights of the centres of the triangles into which `number` cuts of each side divide one."""
    upright = [(i, j) for i in range(number) for j in range(number - i)]
    inverted = [(i, j) for i in range(number - 1) for j in range(number - 1 - i)]
    first = [((i + 1 / 3) / number, (j + 1 / 3) / number) for i, j in upright]
    first += [((i + 2 / 3) / number, (j + 2 / 3) / number) for i, j in inverted]
    return np.array([(u, v, 1.0 - u - v) for u, v in first])


class SheetSamples(OneSidedSamples):
    """Samples on both sides of sheets.

    pattern: their places; spacing and support_radius [m] of the fluid; search_radius [m] within which they are listed;
    origin of the fluid's coordinates [m]; points: how many corners there are.
    `place` [m] and `speed` [m/s] of all corners, in double precision, say where they are.
    """

    def __init__(
        self,
        pattern: Pattern,
        points: int,
        spacing: float,
        support_radius: float,
        search_radius: float,
        origin: np.ndarray,
    ):
        count = 2 * len(pattern.share)
        super().__init__(count, search_radius)
        self.pattern, self.points = pattern, points
        corners = np.repeat(pattern.corners, 2, axis=0)
        # The sign of the share says for which side a sample is.
        sides = np.tile([1.0, -1.0], len(pattern.share))
        self.corners, self.weights = integers(corners.ravel()), vectors(np.repeat(pattern.weights, 2, axis=0))
        share = numbers(sides * np.repeat(pattern.share, 2))
        self._sheets = sheet_sums.Sheets(self.corners, self.weights, share, self.here, self.facing)
        self.of_points = tuple(integers(table) for table in incidence(corners, points))
        self._depth = sample_depth(spacing, support_radius)
        self._weight = sample_weight(spacing, support_radius) * sample_volume(spacing, support_radius) / spacing**2
        self._origin = sheet_sums.vec3d(*origin)
        self.place: ti.Ndarray
        self.speed: ti.Ndarray

    def move(self, samples: ti.Ndarray, velocity: ti.Ndarray) -> float:
        """Write positions [m] with volumes, and velocities [m/s], where `place` and `speed` have the corners; returns
        the greatest speed of a corner [m/s]."""
        return sheet_sums.move(
            self.count,
            self.points,
            self._depth,
            self._weight,
            self._origin,
            self._sheets,
            self.place,
            self.speed,
            samples,
            velocity,
        )

    @property
    def bytes(self) -> int:
        return super().bytes + self.count * (3 * 4 + 3 * 8 + 8 + 3 * 4)


class SheetReaction:
    """Sums for the samples of sheets of `system`, as `sim.coupling.fluid_rigid.reaction` has them for bodies; a load is
    the force on each corner [N]."""

    def __init__(self, system: FluidSystem):
        self.system = system
        self.near = NeighborList(16)
        self._force = self._sway = vectors(np.zeros((0, 3)))

    @property
    def sheets(self) -> SheetSamples:
        """The samples in the system's boundary; raises LookupError where there are none."""
        sheets = self.system.boundary.sheets
        if not isinstance(sheets, SheetSamples):
            raise LookupError("the fluid meets no cloth")
        return sheets

    def list(self) -> None:
        """List the particles near each sample, as the particles' lists are made."""
        system, sheets = self.system, self.sheets
        position = system.particles.position
        if not system.count:
            self.near.clear(sheets.count)
            return
        self.near.build(sheets.here, sheets.count, system.grid, position, same=False)
        sheet_sums.face(sheets.count, sheets.facing, position, self.near.lists)

    def forces(self, terms: Terms, load: ti.Ndarray) -> None:
        """Loads of the forces that positions and velocities give."""
        system, sheets = self.system, self._make_room()
        sheet_sums.push_back(
            terms.bits & BY_SOLIDS,
            sheets.count,
            terms.adhesion_samples,
            terms.coefficients,
            system.resolution,
            system.particles.position,
            system.particles.velocity,
            self.near.lists,
            system.boundary.near_samples,
            system.boundary.faces.lists,
            self._force,
        )
        self._spread(load)

    def pressures(self, ahead: float, load: ti.Ndarray, *, found: bool) -> None:
        """Loads of the pressures in position.w, or where they are `found` in search.x; pairs act where particles will
        be `ahead` [s]."""
        system, sheets = self.system, self._make_room()
        particles, boundary = system.particles, system.boundary
        sheet_sums.press(
            sheets.count,
            ahead,
            system.resolution,
            particles.position,
            particles.velocity,
            particles.search if found else particles.position,
            found,
            self.near.lists,
            boundary.near_samples,
            boundary.faces.lists,
            self._force,
        )
        self._spread(load)

    def add_response(self, ahead: float, displacement: ti.Ndarray, per_displacement: float, *, fresh: bool) -> None:
        """Add to pressure_acceleration.w, or begin there where `fresh`, by how much the displacements [m] of corners,
        over `per_displacement` [s^2], lower the second derivative of densities [kg/(m^3 s^2)]."""
        system, sheets = self.system, self._make_room()
        particles, boundary = system.particles, system.boundary
        sheet_sums.sway(sheets.count, 1.0 / per_displacement, sheets.corners, sheets.weights, displacement, self._sway)
        sheet_sums.add_response(
            system.count,
            fresh,
            ahead,
            system.resolution,
            particles.position,
            particles.velocity,
            boundary.near_samples,
            boundary.faces.lists,
            self._sway,
            particles.pressure_acceleration,
        )

    def _spread(self, load: ti.Ndarray) -> None:
        sheets = self.sheets
        sheet_sums.spread(sheets.points, *sheets.of_points, sheets.weights, self._force, load)

    def _make_room(self) -> SheetSamples:
        if self._force.shape[0] < self.sheets.count:
            self._force, self._sway = (vectors(np.zeros((self.sheets.count, 3))) for _ in range(2))
        return self.sheets

    @property
    def bytes(self) -> int:
        """Memory of the lists of particles near samples, and of forces [bytes]."""
        return self.near.bytes + 2 * 24 * self._force.shape[0]
