"""Samples of the surfaces that the fluid meets, and what they weigh (Akinci et al. 2012)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from sim.fluid.calibration import sample_weight
from sim.fluid.guards import guarding_volumes
from sim.fluid.kernel import cubic_host


@dataclass(frozen=True)
class Samples:
    """points: positions [m], shape [n, 3]; owner: index of the body of each, shape [n]; guarded: the point [m] of a
    sharp edge that each stands behind, shape [n, 3], NaN for those behind faces.
    """

    points: np.ndarray
    owner: np.ndarray
    guarded: np.ndarray

    @classmethod
    def of_faces(cls, points: np.ndarray) -> Samples:
        """All of one body, whose index is 0, and none behind edges."""
        return cls(points, np.zeros(len(points), np.int32), np.full(points.shape, np.nan))

    def moved(self, way: np.ndarray) -> Samples:
        """All moved by `way` [m], shape [3]."""
        return Samples(self.points + way, self.owner, self.guarded + way)

    def volumes(self, group: np.ndarray, spacing: float, support_radius: float) -> np.ndarray:
        """Weighted volumes [m^3] of those with the indices `group`, shape [n], as if there were no others."""
        points = self.points[group]
        by_area = sample_weight(spacing, support_radius) * sample_volumes(points, support_radius)
        return guarding_volumes(points, by_area, self.guarded[group], spacing, support_radius)


def sample_volumes(points: np.ndarray, support_radius: float) -> np.ndarray:
    """V_b = 1 / sum_k W(x_b - x_k) over all boundary samples [m^3] (Akinci et al. 2012, eq. 4)."""
    if not len(points):
        return np.zeros(0)
    tree = cKDTree(points)
    pairs = tree.sparse_distance_matrix(tree, support_radius, output_type="coo_matrix")
    weights = np.bincount(pairs.row, cubic_host(pairs.data, support_radius), minlength=len(points))
    own = float(cubic_host(np.zeros(1), support_radius)[0])
    counted = np.bincount(pairs.row[pairs.row == pairs.col], minlength=len(points))
    return 1.0 / (weights + own * (counted == 0))
