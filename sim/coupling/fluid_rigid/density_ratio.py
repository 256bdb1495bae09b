"""How light a body is against the fluid next to it, which explicit steps have to respect."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import trimesh


def layer_mass_ratio(
    mesh: trimesh.Trimesh, centre: np.ndarray, mass: float, inertia: np.ndarray, layer: float
) -> float:
    """Greatest ratio, over all ways to move, of the mass of the fluid's layer around a body to its own.

    A motion (v, w) of the body moves its surface by n.(v + w x r) along the normal, and the layer of `layer` [kg/m^2]
    there with it: the greatest eigenvalue of M^-1 int layer (n, r x n)(n, r x n)^T dA. `inertia` [kg m^2] is about the
    `centre` [m], all as the body is placed.
    """
    # Midpoints of the edges: exact for squares of the way.
    corners = mesh.triangles - centre
    places = (corners + np.roll(corners, 1, axis=1)) / 2
    normals = np.repeat(mesh.face_normals, 3, axis=0)
    displacements = np.concatenate((normals, np.cross(places.reshape(-1, 3), normals)), axis=1)
    moved = layer * np.einsum("n,ni,nj->ij", np.repeat(mesh.area_faces / 3, 3), displacements, displacements)
    own = np.zeros((6, 6))
    own[:3, :3] = mass * np.eye(3)
    own[3:, 3:] = inertia
    return float(np.linalg.eigvals(np.linalg.solve(own, moved)).real.max())
