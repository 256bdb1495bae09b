"""What the fluid meets: solids, and sheets of cloth, which have samples on both sides (Akinci et al. 2013b)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.device.arrays import numpy_real, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.faces import Faces
from sim.fluid.boundary.shapes import Shapes
from sim.fluid.layout import Samples
from sim.neighbors.spatial_hash import NeighborList

if TYPE_CHECKING:
    from sim.fluid.boundary.one_sided_samples import OneSidedSamples

GAP = 0.1
"""Spacings off a thin solid to which a particle is brought back that has gone through."""


class Boundary:
    """Solids and sheets around the particles of a fluid.

    shapes: the solids; spacing of the fluid and support radius h [m]; search_radius [m], at least h, within which they
    are listed. `samples` holds position and weighted volume of each sample of the sheets [m^3], `velocity` is theirs
    [m/s].
    """

    def __init__(self, shapes: Shapes, spacing: float, h: float, search_radius: float):
        self.shapes = shapes
        self.spacing = spacing
        self.faces = Faces(shapes, spacing, h, search_radius)
        self.elsewhere = Faces(shapes, spacing, h, h)
        """For other points than the particles: where these were, or would have gone."""
        self.sheets: OneSidedSamples | None = None
        self.neighbors = NeighborList(16)
        self.held_off = 0
        """Particles that were brought back since this was last set to zero."""
        self._allocate()

    def _allocate(self) -> None:
        self.samples, self.velocity = (ti.ndarray(vec4, max(self.sampled, 1)) for _ in range(2))
        self.velocity.fill(0)
        self._near_samples: Samples | None = None

    @property
    def sampled(self) -> int:
        """Samples of sheets."""
        return self.sheets.count if self.sheets else 0

    @property
    def near_samples(self) -> Samples:
        """The samples of sheets and which of them are near each particle, as kernels take them."""
        near, known = self.neighbors, self._near_samples
        if known is None or known.index is not near.index:
            self._near_samples = Samples(self.samples, self.velocity, near.begin, near.size, near.index)
        return self._near_samples

    @property
    def moves(self) -> bool:
        """Whether any solid or sheet does."""
        return bool(self.shapes.moving) or self.sampled > 0

    @property
    def has_bodies(self) -> bool:
        """Whether there is more than planes, on which a force may be asked for."""
        return self.shapes.bodies > 0 or self.sampled > 0

    @property
    def speed(self) -> float:
        """Of the fastest point of a solid or sheet [m/s]."""
        return max(self.shapes.speed, self._sheet_speed)

    _sheet_speed = 0.0

    def attach(self, sheets: OneSidedSamples) -> None:
        """Let these be the samples of sheets, in place of those there were; `move` brings all to where they are."""
        self.sheets = sheets
        self._allocate()

    def aim(self, motions: np.ndarray) -> None:
        """Say how bodies will have moved after the next `move`: a row of MOTION numbers for each that moves, in their
        order, relative to the world's origin."""
        self.motions = motions

    def move(self) -> None:
        """Bring what moves to where it was aimed at; it is to be listed anew, or placed."""
        if self.shapes.moving:
            self.shapes.move(self.motions)
        if self.sheets:
            self._sheet_speed = self.sheets.move(self.samples, self.velocity)

    def list(self, position: ti.Ndarray, count: int) -> None:
        """List the solids and samples near each of `count` particles."""
        self.faces.find(position, count)
        if self.sheets and count:
            self.sheets.find(position, count)
            self.sheets.tell(position, count, self.neighbors)

    def around(self, points: np.ndarray) -> Faces:
        """What solids are to other points than the particles [m], shape [n, 3], until the next are asked for."""
        here = ti.ndarray(vec4, len(points))
        here.from_numpy(np.column_stack((points, np.zeros(len(points)))).astype(numpy_real))
        self.elsewhere.find(here, len(points))
        self.elsewhere.place(self.elsewhere.points(here, here), len(points), 0.0)
        return self.elsewhere

    def prevent_penetration(self, position: ti.Ndarray, velocity: ti.Ndarray, count: int) -> None:
        """Keep particles on their side of what is thin."""
        self.held_off += self.faces.prevent_penetration(position, velocity, count, GAP * self.spacing)

    @property
    def bytes(self) -> int:
        """Memory of the solids, of those near particles, and of the samples of sheets [bytes]."""
        sheets = self.sheets.bytes + 8 * np.dtype(numpy_real).itemsize * self.sampled if self.sheets else 0
        return self.shapes.bytes + self.faces.bytes + self.neighbors.bytes + sheets
