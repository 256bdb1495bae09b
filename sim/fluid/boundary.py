"""Boundary samples of solid surfaces (Akinci et al. 2012)."""

from __future__ import annotations

import numpy as np
import taichi as ti

from sim.arrays import numpy_real, vec4
from sim.fluid.calibration import sample_weight
from sim.fluid.kernel import cubic_host
from sim.neighbors import NeighborList, StaticGrid


class Boundary:
    """Samples of surfaces that do not move.

    points: positions [m], shape [n, 3]; owner: index of the body of each, shape [n]; spacing [m] of the fluid;
    search_radius [m], at least the support radius, within which they are listed.
    `samples` holds position and weighted volume of each sample [m^3], in the order of the cells.
    """

    def __init__(
        self, points: np.ndarray, owner: np.ndarray, spacing: float, support_radius: float, search_radius: float
    ):
        self.count = len(points)
        self.grid = StaticGrid(points, search_radius)
        order = self.grid.order
        self.points = points[order]
        self.owner = owner[order]
        self.volumes = sample_weight(spacing, support_radius) * sample_volumes(points, support_radius)[order]
        self.samples = ti.ndarray(vec4, max(self.count, 1))
        if self.count:
            self.samples.from_numpy(np.column_stack((self.points, self.volumes)).astype(numpy_real))
        self.neighbors = NeighborList(48)

    def find_neighbors(self, position: ti.Ndarray, count: int) -> None:
        """List the samples near each of `count` particles."""
        if self.count:
            self.neighbors.build(position, count, self.grid, self.samples, same=False)

    @property
    def bytes(self) -> int:
        return 16 * self.count + self.grid.bytes + self.neighbors.bytes


def sample_volumes(points: np.ndarray, support_radius: float) -> np.ndarray:
    """V_b = 1 / sum_k W(x_b - x_k) over all boundary samples [m^3] (Akinci et al. 2012, eq. 4)."""
    if not len(points):
        return np.zeros(0)
    from scipy.spatial import cKDTree

    tree = cKDTree(points)
    pairs = tree.sparse_distance_matrix(tree, support_radius, output_type="coo_matrix")
    weights = np.bincount(pairs.row, cubic_host(pairs.data, support_radius), minlength=len(points))
    own = float(cubic_host(np.zeros(1), support_radius)[0])
    counted = np.bincount(pairs.row[pairs.row == pairs.col], minlength=len(points))
    return 1.0 / (weights + own * (counted == 0))
