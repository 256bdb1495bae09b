"""Boundary samples of solid surfaces (Akinci et al. 2012)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import taichi as ti

from sim.arrays import numpy_real, vec4
from sim.neighbors import NeighborList, StaticGrid

if TYPE_CHECKING:
    from sim.fluid.moving import Listed, MovingSamples
    from sim.fluid.samples import Samples
    from sim.fluid.sheets import SheetSamples


class Boundary:
    """Samples of surfaces: those that stand, in the order of their cells, those of bodies that move, those of sheets.

    found: all of them; spacing [m] of the fluid;
    search_radius [m], at least the support radius, within which they are listed; pivots: own origin [m], shape [3], of
    the bodies that move, by index. Points and pivots are where the bodies are placed.
    `samples` holds position and weighted volume of each sample [m^3]; `velocity` is given where some move [m/s].
    """

    def __init__(
        self,
        found: Samples,
        spacing: float,
        support_radius: float,
        search_radius: float,
        pivots: dict[int, np.ndarray],
    ):
        points, owner = found.points, found.owner
        self.count = len(points)
        moving = np.isin(owner, list(pivots))
        self.grid = StaticGrid(points[~moving], search_radius)
        # Volumes of bodies that move are their own: they can not depend on where a run goes on.
        groups = [np.flatnonzero(~moving), *(np.flatnonzero(owner == index) for index in pivots)]
        volumes = np.concatenate([found.volumes(group, spacing, support_radius) for group in groups])
        self.standing = len(groups[0])
        in_cells = np.concatenate((self.grid.order, np.arange(self.standing, self.count)))
        order = np.concatenate(groups)[in_cells]
        self.points, self.owner, self.volumes = points[order], owner[order], volumes[in_cells]
        self.sheets: SheetSamples | None = None
        self.speed = 0.0
        """Of the fastest sample [m/s]."""
        self._allocate()
        self.neighbors = NeighborList(48)
        self.moving: MovingSamples | None = None
        if self.moves:
            from sim.fluid.moving import MovingSamples

            arms = [points[group] - pivots[index] for index, group in zip(pivots, groups[1:], strict=True)]
            body = np.repeat(np.arange(len(pivots)), [len(group) for group in groups[1:]])
            self.moving = MovingSamples(
                self.standing, np.concatenate(arms), body, self.volumes[self.standing :], search_radius
            )

    @property
    def moves(self) -> bool:
        return self.count > self.standing

    def _allocate(self) -> None:
        self.samples = ti.ndarray(vec4, max(self.count, 1))
        if self.count:
            table = np.zeros((self.count, 4), numpy_real)
            table[: len(self.points)] = np.column_stack((self.points, self.volumes))
            self.samples.from_numpy(table)
        self.velocity = ti.ndarray(vec4, self.count if self.moves else 1)
        self.velocity.fill(0)

    def attach(self, sheets: SheetSamples) -> None:
        """Let these be the samples of sheets, in place of those there were; `move` brings all to where they are."""
        self.sheets = sheets
        self.count = len(self.points) + sheets.count
        self._allocate()

    def aim(self, motions: np.ndarray) -> None:
        """Say how bodies will have moved after the next `move`: a row of MOTION numbers for each, in the order of the
        pivots, relative to the world's origin."""
        self.motions = motions

    def move(self) -> None:
        """Bring the samples that move to where they were aimed at; neighbours are to be listed anew."""
        self.speed = 0.0
        if self.moving:
            self.moving.move(self.motions, self.samples, self.velocity)
            self.speed = self.moving.fastest(self.motions)
        if self.sheets:
            self.speed = max(self.speed, self.sheets.move(self.samples, self.velocity))

    def find_neighbors(self, position: ti.Ndarray, count: int) -> None:
        """List the samples near each of `count` particles."""
        if self.standing:
            self.neighbors.build(position, count, self.grid, self.samples, same=False)
        if not count:
            return
        fresh = not self.standing
        for listed in self._listed:
            listed.find(position, count)
            self.neighbors.reserve(count)
            longest = listed.append(position, count, self.neighbors, fresh=fresh)
            if longest > self.neighbors.capacity:
                self.neighbors.grow(longest)
                self.find_neighbors(position, count)
                return
            fresh = False

    @property
    def _listed(self) -> list[Listed]:
        return [item for item in (self.moving, self.sheets) if item]

    def of_body(self, owner: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The samples of one body: positions [m] and velocities [m/s], shape [n, 3], and weighted volumes [m^3]."""
        which = self.owner == owner
        if not (self.moves and which[self.standing :].any()):
            return self.points[which], np.zeros((np.count_nonzero(which), 3)), self.volumes[which]
        rows = np.flatnonzero(which)
        position, velocity = (array.to_numpy()[rows, :3].astype(np.float64) for array in (self.samples, self.velocity))
        return position, velocity, self.volumes[which]

    @property
    def bytes(self) -> int:
        table = 4 * np.dtype(numpy_real).itemsize * self.count
        own = table + self.grid.bytes + self.neighbors.bytes
        return own + (table if self.moves else 0) + sum(listed.bytes for listed in self._listed)
