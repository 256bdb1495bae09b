"""How much samples behind sharp edges weigh: what it takes to hold a single particle, and no more.

By the area that it stands for, a sample of a row behind an edge would weigh several times as much as one behind a face
(its neighbours are few), and fluid would keep off the edge as if the body were larger.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from sim.fluid.kernel import cubic_host, particle_mass

MARGIN = 0.03
"""Density over the rest density, less one, of a single particle on an edge."""
BETWEEN = 1.3
"""Points of edges up to this many spacings apart are guarded half way, too."""
ROUNDS = 12


def guarding_volumes(
    points: np.ndarray, volumes: np.ndarray, guarded: np.ndarray, spacing: float, h: float
) -> np.ndarray:
    """Weighted volumes [m^3], shape [n], lowered for samples that stand behind edges.

    points [m], shape [n, 3]; volumes: as they follow from areas, weighted; guarded: the point of an edge [m] that each
    stands behind, NaN for samples of faces, shape [n, 3].

    All are lowered as long as the density m W(0) + rho0 sum V_b W of a particle alone is above rho0 at each of the
    points within the support radius that are guarded. By no step does it fall below there: every sample that counts
    at such a point is lowered by the excess of that point at most.
    """
    rows = np.flatnonzero(~np.isnan(guarded[:, 0]))
    if not len(rows):
        return volumes
    edge = guarded[rows]
    pairs = cKDTree(edge).query_pairs(BETWEEN * spacing, output_type="ndarray")
    places = np.concatenate((edge, edge[pairs].mean(axis=1)))
    weights = _kernel(places, points, h)
    near = weights[:, rows].T.tocsr()
    own = particle_mass(spacing, h, 1.0) * float(cubic_host(np.zeros(1), h)[0])
    of_faces = np.where(np.isnan(guarded[:, 0]), volumes, 0.0)
    lacking = np.maximum(1.0 + MARGIN - own - weights @ of_faces, 0.0)
    lowered = volumes[rows]
    for _ in range(ROUNDS):
        share = lacking / np.maximum(near.T @ lowered, 1e-300)
        lowered = lowered * np.minimum(near.sign().multiply(share[None, :]).max(axis=1).toarray().ravel(), 1.0)
    of_faces[rows] = lowered
    return of_faces


def _kernel(places: np.ndarray, points: np.ndarray, h: float) -> csr_matrix:
    """W [1/m^3] between places and points, shape [places, points], where it is not zero."""
    pairs = cKDTree(places).sparse_distance_matrix(cKDTree(points), h, output_type="coo_matrix")
    values = cubic_host(pairs.data, h)
    inside = values > 0
    return csr_matrix((values[inside], (pairs.row[inside], pairs.col[inside])), shape=(len(places), len(points)))
