"""Mass, centre and inertia of solids."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused

if TYPE_CHECKING:
    import trimesh


@dataclass(frozen=True)
class MassProperties:
    """Mass properties of a rigid body of uniform density."""

    mass: float
    """[kg]"""
    volume: float
    """[m^3]"""
    centre: np.ndarray
    """Centre of mass [m], shape [3]."""
    inertia: np.ndarray
    """Inertia tensor about the centre of mass in world axes [kg m^2], shape [3, 3]."""
    moments: np.ndarray
    """Principal moments of inertia, ascending [kg m^2], shape [3]."""
    axes: np.ndarray
    """Proper rotation whose columns are the principal axes: inertia = axes @ diag(moments) @ axes.T, shape [3, 3]."""

    def scaled_to(self, mass: float) -> MassProperties:
        """The same body with another mass [kg]."""
        factor = mass / self.mass
        return MassProperties(mass, self.volume, self.centre, self.inertia * factor, self.moments * factor, self.axes)


def mass_properties(mesh: trimesh.Trimesh, density: float) -> MassProperties:
    """Mass properties of a closed mesh filled with `density` [kg/m^3].

    Integrals of 1, x and x x^T over the signed tetrahedra from the mesh's middle to its faces (Blow & Binstock
    2004; the covariance of a tetrahedron is that of Eberly 2002): exact for the polyhedron.

    Raises `Refused` for an open or inverted mesh, one whose pieces overlap or that cuts through itself (what they have
    in common would count twice), and for moments that no body has.
    """
    from sim.geometry.meshes.overlap import COUNTED_WRONGLY, overlapping_pieces, volume_counted_wrongly
    from sim.geometry.meshes.topology import Topology

    topology = Topology.of(mesh)
    if not topology.watertight or not topology.consistent:
        raise Refused(
            f"the mass of an open mesh is undefined: {topology.boundary_edges} edges have a face on one side only",
            remedy="Repair the mesh (repair: true), or close it in a modelling program",
        )
    corners = np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    middle = corners.mean(axis=(0, 1))
    corners = corners - middle
    determinant = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    volume = determinant.sum() / 6
    if not volume > 0:
        raise Refused(
            f"the mesh is inside out: its volume is {volume:.3g} m^3",
            remedy="Repair the mesh (repair: true), or turn its faces outward",
        )
    if common := overlapping_pieces(mesh):
        raise Refused(
            f"{common} pieces of the mesh overlap others: their common volume would count twice",
            remedy="Unite the pieces (Boolean union) in a modelling program",
        )
    share = volume_counted_wrongly(mesh) / volume
    if share > COUNTED_WRONGLY:
        raise Refused(
            f"the mesh cuts through itself: {100 * share:.3g} % of its volume would count twice or be negative",
            remedy="Unite it with itself (Boolean union) in a modelling program",
        )
    total = corners.sum(axis=1)
    first = np.einsum("i,ij->j", determinant, total) / 24
    # Integral of x x^T over a tetrahedron (0, a, b, c): det/120 (sum of a a^T + (a+b+c)(a+b+c)^T).
    second = (
        np.einsum("i,ikx,iky->xy", determinant, corners, corners) + np.einsum("i,ix,iy->xy", determinant, total, total)
    ) / 120
    centre = first / volume
    return from_covariance(
        density * volume, volume, centre + middle, density * (second - volume * np.outer(centre, centre))
    )


def from_covariance(mass: float, volume: float, centre: np.ndarray, covariance: np.ndarray) -> MassProperties:
    """Mass properties from the second moments C = integral of rho x x^T about the centre [kg m^2]: I = tr(C) 1 - C.

    Raises `Refused` when they are not finite and positive, or break the triangle inequality of the moments.
    """
    covariance = (covariance + covariance.T) / 2
    inertia = np.trace(covariance) * np.eye(3) - covariance
    if not (math.isfinite(mass) and np.isfinite(inertia).all() and mass > 0):
        raise Refused(f"the body has no finite mass ({mass:.3g} kg)", remedy="Check its size and its density")
    moments, axes = np.linalg.eigh(inertia)
    # Every body obeys I1 + I2 >= I3; equality is a flat one, so leave rounding alone.
    if moments[0] <= 0 or moments[0] + moments[1] < moments[2] * (1 - 1e-9):
        raise Refused(
            f"the principal moments {moments[0]:.4g}, {moments[1]:.4g}, {moments[2]:.4g} kg m^2 are those of no body "
            "(the largest exceeds the sum of the others)",
            remedy="Unite the mesh with itself (Boolean union) in a modelling program",
        )
    if np.linalg.det(axes) < 0:
        axes[:, 2] = -axes[:, 2]
    return MassProperties(float(mass), float(volume), np.asarray(centre, dtype=np.float64), inertia, moments, axes)
