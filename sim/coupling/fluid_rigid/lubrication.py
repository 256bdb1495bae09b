"""Films of fluid that have no room for particles: under a body that lies on the ground, between bodies that touch.

In a film of even thickness that nothing stirs the pressure obeys Laplace's equation (Reynolds 1886), between the
pressures along its rim; that of a half-plane is the mean of those, each by one over the square of its distance, and so
is taken everywhere. Up and down in a film pressure changes by the weight of the fluid. It acts on bodies that move
only; what lies dry all around has none under it. The pressures at rims are those that are looked for: they stand in the
equations of `sim.coupling.fluid_rigid.reaction`, with the opposite of what they do to bodies. A body that is lifted off
the ground so draws in fluid from its rim, and can come up no faster than that lets it.

Where one or two layers of particles are in a gap, they press on what encloses them by how well they fit in, and not by
the pressure around (`sim.fluid.boundary.gaps.openness`): there, too, the film acts in their place.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sim.coupling.fluid_rigid.lubrication_sums import Elements, add_response_at_rims, place, press, press_rims
from sim.device.arrays import integer_array, numpy_real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.faces import Faces
from sim.fluid.boundary.gaps import WIDE
from sim.fluid.boundary.shapes import MOTION
from sim.fluid.system import FluidSystem
from sim.geometry.distance.closest_points import cover
from sim.geometry.thinning import first_come
from sim.neighbors.spatial_hash import NeighborList

if TYPE_CHECKING:
    import trimesh

APART = 0.8
"""Elements of a surface stand this many spacings apart, or on faces that are turned by half of it in radians."""
BESIDE = 1.6
"""Elements that are so many spacings apart may share the rim of a film."""


def elements(mesh: trimesh.Trimesh, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] of a surface and the areas [m^2] that they stand for, as vectors outward; both of shape [n, 3].

    The areas of a closed surface add up to nothing.
    """
    points, faces, _ = cover(mesh.triangles, int(4 * mesh.area / spacing**2) + 1)
    areas = (mesh.area_faces / np.bincount(faces, minlength=len(mesh.faces)))[faces, None] * mesh.face_normals[faces]
    both = np.concatenate((points / spacing, 2.0 * mesh.face_normals[faces]), axis=1)
    kept = first_come(both, APART)
    _, nearest = cKDTree(both[kept]).query(both)
    weight = np.linalg.norm(areas, axis=1)
    centre, area = np.zeros((len(kept), 3)), np.zeros((len(kept), 3))
    np.add.at(centre, nearest, weight[:, None] * points)
    np.add.at(area, nearest, areas)
    return centre / np.bincount(nearest, weight)[:, None], area


class Lubrication:
    """The films about the bodies that are the `solids` in the boundary of `system`.

    surfaces: of these bodies as placed; pivots: their own origins [m], as placed, shape [3] each.
    """

    def __init__(
        self,
        system: FluidSystem,
        solids: Sequence[int],
        surfaces: Sequence[trimesh.Trimesh],
        pivots: Sequence[np.ndarray],
    ):
        self.system = system
        spacing = system.spec.spacing
        parts = [elements(mesh, spacing) for mesh in surfaces]
        arms = np.concatenate([points - pivot for (points, _), pivot in zip(parts, pivots, strict=True)])
        areas = np.concatenate([area for _, area in parts])
        sizes = [len(points) for points, _ in parts]
        body = np.repeat(np.arange(len(parts)), sizes)
        self.count = len(arms)
        self.reach = WIDE * spacing
        """By how much [m] the boxes around bodies have to be enlarged to overlap where there is a film."""
        self._elements = Elements(
            _vectors(arms),
            _vectors(areas),
            integer_array(body),
            integer_array(np.repeat(np.asarray(solids), sizes)),
            integer_array(np.concatenate(([0], np.cumsum(sizes)))),
            integer_array(_beside(arms, body, BESIDE * spacing)),
            ti.ndarray(ti.f64, (len(parts), MOTION)),
            *(ti.ndarray(vec4, self.count) for _ in range(6)),
            ti.ndarray(ti.f64, (self.count, 6)),
        )
        self._wrench = ti.ndarray(ti.f64, (len(parts), 6))
        self._at_rim = ti.ndarray(ti.f64, (self.count, 1))
        self.active = False
        self.steady = np.zeros((len(parts), 6))
        """Wrenches but for the pressures at rims: force [N] and torque about their own origins [N m]."""
        self._near, self._far = NeighborList(16), NeighborList(16)
        boundary = system.boundary
        self._others = Faces(boundary.shapes, spacing, system.h, WIDE * spacing)

    def find(self, motions: np.ndarray) -> None:
        """Look for films about bodies that have moved by `motions`; particles and solids are where they are now."""
        self.active = True
        system = self.system
        particles, others, elements = system.particles, self._others, self._elements
        elements.motions.from_numpy(np.ascontiguousarray(motions))
        place(elements, system.spec.spacing)
        self._near.build(elements.ahead, self.count, system.grid, particles.position, same=False)
        self._far.build(elements.beyond, self.count, system.grid, particles.position, same=False)
        others.find(elements.here, self.count, elements.own)
        others.place(self._others.points(elements.here, elements.here), self.count, 0.0)
        press(
            system.resolution,
            vec3(*system.gravity),
            particles.position,
            system.boundary.shapes.slim,
            elements,
            self._near.lists,
            self._far.lists,
            others.lists,
            self._wrench,
        )
        self.steady = self._wrench.to_numpy()

    def forget(self) -> None:
        """No body is near anything."""
        self.active = False
        self.steady = np.zeros_like(self.steady)

    def pressed(self, pressure: ti.Ndarray, wrench: ti.Ndarray, *, found: bool) -> None:
        """Write the wrenches by pressures at rims as q, in w, or where they are `found` in x."""
        system = self.system
        press_rims(
            system.resolution,
            system.particles.position,
            pressure,
            found,
            self._elements,
            self._far.lists,
            self._at_rim,
            wrench,
        )

    def add_response(self, response: ti.Ndarray) -> None:
        """Add to pressure_acceleration.w what accelerations of bodies, shape [bodies, 6], do to particles at rims."""
        system = self.system
        add_response_at_rims(
            system.resolution,
            system.particles.position,
            self._elements,
            self._far.lists,
            response,
            system.particles.pressure_acceleration,
        )


def _beside(points: np.ndarray, body: np.ndarray, radius: float) -> np.ndarray:
    """For each element those of its own body within `radius` [m], itself in the places that are left."""
    apart = np.column_stack((points, 10.0 * (1.0 + np.ptp(points)) * body))
    pairs = cKDTree(apart).query_pairs(radius, output_type="ndarray")
    both = np.concatenate((pairs, pairs[:, ::-1]))
    both = both[np.argsort(both[:, 0], kind="stable")]
    sizes = np.bincount(both[:, 0], minlength=len(points))
    rank = np.arange(len(both)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    table = np.repeat(np.arange(len(points))[:, None], max(int(sizes.max(initial=0)), 1), axis=1)
    table[both[:, 0], rank] = both[:, 1]
    return table


def _vectors(values: np.ndarray) -> ti.Ndarray:
    array = ti.ndarray(vec4, len(values))
    array.from_numpy(np.column_stack((values, np.zeros(len(values)))).astype(numpy_real))
    return array
