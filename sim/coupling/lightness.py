"""How light a body is against the fluid next to it, which explicit steps have to respect."""

from __future__ import annotations

import numpy as np
import trimesh


def lightness(mesh: trimesh.Trimesh, centre: np.ndarray, mass: float, inertia: np.ndarray, layer: float) -> float:
    """Greatest ratio, over all ways to move, of the mass of the fluid's layer around a body to its own.

    A motion (v, w) of the body moves its surface by n.(v + w x r) along the normal, and the layer of `layer` [kg/m^2]
    there with it: the greatest eigenvalue of M^-1 int layer (n, r x n)(n, r x n)^T dA. `inertia` [kg m^2] is about the
    `centre` [m], all as the body is placed.
    """
    arms = np.cross(mesh.triangles_center - centre, mesh.face_normals)
    ways = np.concatenate((mesh.face_normals, arms), axis=1)
    moved = layer * np.einsum("n,ni,nj->ij", mesh.area_faces, ways, ways)
    own = np.zeros((6, 6))
    own[:3, :3] = mass * np.eye(3)
    own[3:, 3:] = inertia
    return float(np.linalg.eigvals(np.linalg.solve(own, moved)).real.max())
