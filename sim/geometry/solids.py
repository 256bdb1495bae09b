"""Placed shapes: volume, inside test, signed distance and mass. Those with closed forms are in `analytic_solids`."""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.geometry.mass import MassProperties, mass_properties
from sim.geometry.pose import Pose
from sim.geometry.triangles import Triangles

if TYPE_CHECKING:
    import trimesh

    from sim.geometry.meshes.repair_report import RepairReport


UP = np.array([0.0, 1.0, 0.0])


class Solid(ABC):
    """A placed shape. All coordinates are those of the world [m]."""

    closed = True
    """Whether the shape has an inside."""
    report: RepairReport | None = None
    """What was mended in a mesh file."""

    def __init__(self, pose: Pose, local: Callable[[], Triangles] | None):
        """local: makes the surface in the shape's own frame, once something asks for it; None for a plane."""
        self.pose = pose
        self._local = local

    @functools.cached_property
    def triangles(self) -> Triangles | None:
        """The surface in world space, faces outward, in the colours of its file if it has any; None for a plane."""
        if self._local is None:
            return None
        local = self._local()
        return local._replace(vertices=self.pose.to_world(local.vertices))

    @functools.cached_property
    def mesh(self) -> trimesh.Trimesh | None:
        """The triangles as a mesh of the library; None for a plane."""
        return None if self.triangles is None else self.triangles.mesh()

    @property
    def surface(self) -> trimesh.Trimesh:
        """The mesh of a shape that ends somewhere; raises ValueError for a plane."""
        if self.mesh is None:
            raise ValueError("a plane has no mesh")
        return self.mesh

    @property
    @abstractmethod
    def bounds(self) -> np.ndarray:
        """Lower and upper corner of the axis-parallel bounding box [m], shape [2, 3]."""

    @property
    @abstractmethod
    def volume(self) -> float:
        """[m^3]"""

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Whether points [m], shape [n, 3], lie inside; bool, shape [n]."""
        return self.signed_distance(points) < 0

    @abstractmethod
    def signed_distance(self, points: np.ndarray) -> np.ndarray:
        """Distance to the surface, negative inside [m], shape [n]."""

    def distance_and_slope(self, points: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Signed distance [m] of points [m], shape [n, 3], and its gradient, the unit vector out of the solid; shapes
        [n] and [n, 3].

        Where the gradient jumps, as on a ridge, it is that of one side or a mean of both. A mesh looks no further than
        `reach` [m]: points beyond are infinitely far, and their gradient is 0.
        """
        step = 1e-6 * float(np.ptp(self.bounds, axis=0).max())
        corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
        around = [self.signed_distance(points + step * corner) for corner in corners]
        slope = np.stack(around, axis=1) @ corners
        length = np.linalg.norm(slope, axis=1, keepdims=True)
        return self.signed_distance(points), np.where(length > 0, slope / np.maximum(length, 1e-300), UP)

    def contains_lattice(self, origin: np.ndarray, spacing: float, shape: tuple[int, int, int]) -> np.ndarray:
        """Whether the points of a cubic lattice, whose first point is `origin` [m], lie inside; bool array of `shape`.

        The quick way for many points of a mesh.
        """
        axes = [origin[axis] + spacing * np.arange(shape[axis]) for axis in range(3)]
        inside = np.empty(shape, dtype=bool)
        for index, x in enumerate(axes[0]):
            grid = np.stack(np.meshgrid([x], axes[1], axes[2], indexing="ij"), axis=-1).reshape(-1, 3)
            inside[index] = self.contains(grid).reshape(shape[1:])
        return inside

    @abstractmethod
    def mass_properties(self, density: float) -> MassProperties:
        """Mass properties when filled with `density` [kg/m^3]; `Refused` where there are none."""


class PlaneSolid(Solid):
    """The half-space below a plane through the pose's position."""

    def __init__(self, pose: Pose, normal: tuple[float, float, float]):
        super().__init__(pose, None)
        self.normal = pose.rotation @ (np.array(normal, dtype=np.float64) / np.linalg.norm(normal))
        """Unit vector out of the solid, in world axes, shape [3]."""

    @property
    def bounds(self) -> np.ndarray:
        bounds = np.array([np.full(3, -np.inf), np.full(3, np.inf)])
        axis = int(np.abs(self.normal).argmax())
        if abs(self.normal[axis]) == 1.0:
            bounds[int(self.normal[axis] > 0), axis] = self.pose.position[axis]
        return bounds

    @property
    def volume(self) -> float:
        return np.inf

    def signed_distance(self, points: np.ndarray) -> np.ndarray:
        return (np.asarray(points, dtype=np.float64).reshape(-1, 3) - self.pose.position) @ self.normal

    def distance_and_slope(self, points: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        return self.signed_distance(points), np.tile(self.normal, (len(points), 1))

    def mass_properties(self, density: float) -> MassProperties:
        raise Refused("a plane has no finite mass", remedy="Let it be static, or use a box")


class MeshSolid(Solid):
    """The inside of a closed mesh: where its winding number is positive, so that overlapping pieces unite."""

    def __init__(self, pose: Pose, mesh: trimesh.Trimesh, report: RepairReport | None = None):
        super().__init__(pose, lambda: Triangles.of(mesh))
        self.report = report

    @property
    def bounds(self) -> np.ndarray:
        return np.array(self.surface.bounds)

    @functools.cached_property
    def volume(self) -> float:
        from sim.geometry.meshes.topology import signed_volume

        return signed_volume(self.surface)

    @functools.cached_property
    def _winding(self):
        from sim.geometry.meshes.winding import WindingNumber

        return WindingNumber(self.surface)

    @functools.cached_property
    def _distance(self):
        from sim.geometry.distance.closest_points import MeshDistance

        return MeshDistance(self.surface)

    def contains(self, points: np.ndarray) -> np.ndarray:
        return self._winding.at(points) > 0

    def contains_lattice(self, origin: np.ndarray, spacing: float, shape: tuple[int, int, int]) -> np.ndarray:
        return self._winding.on_lattice(origin, spacing, shape) > 0

    def signed_distance(self, points: np.ndarray) -> np.ndarray:
        distance = self._distance.unsigned(points)
        return np.where(self.contains(points), -distance, distance)

    def distance_and_slope(self, points: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        sign = np.where(self.contains(points), -1.0, 1.0)
        distance, slope = np.full(len(points), np.inf), np.zeros((len(points), 3))
        near = self._distance.within(points, reach)
        foot, distance[near], face = self._distance.closest(points[near])
        # On the surface the way from its nearest point says nothing.
        on = distance[near] < 1e-9 * float(np.ptp(self.bounds, axis=0).max())
        away = sign[near, None] * (points[near] - foot) / np.maximum(distance[near], 1e-300)[:, None]
        slope[near] = np.where(on[:, None], self.surface.face_normals[face], away)
        return sign * distance, slope

    @functools.cached_property
    def _of_unit_density(self) -> MassProperties:
        return mass_properties(self.surface, 1.0)

    def mass_properties(self, density: float) -> MassProperties:
        return self._of_unit_density.scaled_to(density * self._of_unit_density.volume)


class SheetSolid(Solid):
    """A surface without inside: nothing is contained, and distances are positive."""

    closed = False

    def __init__(self, pose: Pose, local: Callable[[], Triangles], size: tuple[float, float]):
        super().__init__(pose, local)
        self.size = np.array(size, dtype=np.float64)
        """Edge lengths along its own x and z before scaling [m], shape [2]."""

    @property
    def bounds(self) -> np.ndarray:
        return np.array(self.surface.bounds)

    @property
    def volume(self) -> float:
        return 0.0

    def contains(self, points: np.ndarray) -> np.ndarray:
        return np.zeros(np.asarray(points).reshape(-1, 3).shape[0], dtype=bool)

    def signed_distance(self, points: np.ndarray) -> np.ndarray:
        local = self.pose.to_local(points)
        beyond = np.maximum(np.abs(local[:, [0, 2]]) - self.size / 2, 0.0)
        return self.pose.scale * np.sqrt((beyond**2).sum(axis=1) + local[:, 1] ** 2)

    def mass_properties(self, density: float) -> MassProperties:
        raise Refused("a sheet has no volume and no mass", remedy="Let it be static, or use a thin box")
