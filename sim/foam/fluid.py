"""The fluid between two of its frames."""

from __future__ import annotations

import numpy as np

from sim.device.arrays import numpy_real, real, vec4
from sim.device.compiler import ti
from sim.foam.sums import potentials, surface_normals, surroundings
from sim.neighbors.spatial_hash import HashGrid, NeighborList

EXPECTED = 32
"""Neighbours that lists have room for at first."""


def hermite(s: float, T: float, x0: np.ndarray, v0: np.ndarray, x1: np.ndarray, v1: np.ndarray) -> np.ndarray:
    """After a share `s` of the time `T` [s], on the cubic with positions [m] x0, x1 and velocities [m/s] v0, v1 at its
    ends."""
    start = (1 + 2 * s) * (1 - s) ** 2 * x0 + s * (1 - s) ** 2 * T * v0
    return start + s * s * (3 - 2 * s) * x1 + s * s * (s - 1) * T * v1


class Passage:
    """Particles on their way from one frame to the next; those that only one of the frames has are left out.

    before, after: records of `fluid_00042.ply`. `duration` [s] lies between them.
    """

    def __init__(self, before: np.ndarray, after: np.ndarray, duration: float):
        _, left, right = np.intersect1d(before["id"], after["id"], assume_unique=True, return_indices=True)
        self.duration = duration
        self._x0, self._v0 = _vectors(before[left], "xyz"), _vectors(before[left], ("vx", "vy", "vz"))
        self._x1, self._v1 = _vectors(after[right], "xyz"), _vectors(after[right], ("vx", "vy", "vz"))

    def at(self, share: float) -> tuple[np.ndarray, np.ndarray]:
        """Positions [m] by the cubic that fits both ends, and velocities [m/s] on the straight line between those of
        the ends, which therefore do not exceed them; shape [n, 3]."""
        position = hermite(share, self.duration, self._x0, self._v0, self._x1, self._v1)
        return position, (1 - share) * self._v0 + share * self._v1


class Fluid:
    """Particles at one time, and what foam wants to know of them.

    position [m], velocity [m/s]: shape [n, 3]. h: support radius [m]. spacing of the particles at rest [m].
    """

    def __init__(self, position: np.ndarray, velocity: np.ndarray, h: float, spacing: float):
        self.count, self._h, self._spacing = len(position), h, spacing
        self._grid = HashGrid(self.count, h)
        order = np.empty(0, np.int64)
        if self.count:
            order = self._grid.sort(_array(position), self.count).to_numpy()[: self.count]
        self.position, self.velocity = position[order], velocity[order]
        self._position, self._velocity = _array(self.position), _array(self.velocity)

    def potentials(self) -> tuple[np.ndarray, np.ndarray]:
        """Trapped air [m/s] and wave crest [1] of the particles; shape [n]."""
        lists = NeighborList(EXPECTED)
        lists.build(self._position, self.count, self._grid, self._position, same=True)
        normal = ti.ndarray(vec4, max(self.count, 1))
        trapped, crest = (_numbers(self.count) for _ in range(2))
        if self.count:
            surface_normals(self.count, self._h, self._spacing**3, self._position, lists.lists, normal)
            potentials(
                self.count,
                self._h,
                self._position,
                self._velocity,
                normal,
                lists.lists,
                trapped,
                crest,
            )
        return trapped.to_numpy()[: self.count], crest.to_numpy()[: self.count]

    def around(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Velocity of the fluid around points [m], shape [n, 3], and how many particles are within h, shape [n]."""
        if not (len(points) and self.count):
            return np.zeros((len(points), 3), np.float32), np.zeros(len(points), np.int64)
        here = _array(points)
        lists = NeighborList(EXPECTED)
        lists.build(here, len(points), self._grid, self._position, same=False)
        found = ti.ndarray(vec4, len(points))
        surroundings(len(points), self._h, here, self._position, self._velocity, lists.lists, found)
        table = found.to_numpy()
        return table[:, :3], table[:, 3].astype(np.int64)


def _vectors(points: np.ndarray, names: tuple[str, ...] | str) -> np.ndarray:
    return np.stack([points[name] for name in names], axis=1).astype(np.float64)


def _array(vectors: np.ndarray) -> ti.Ndarray:
    padded = np.zeros((max(len(vectors), 1), 4), numpy_real)
    padded[: len(vectors), :3] = vectors
    array = ti.ndarray(vec4, len(padded))
    array.from_numpy(padded)
    return array


def _numbers(count: int) -> ti.Ndarray:
    return ti.ndarray(real, max(count, 1))
