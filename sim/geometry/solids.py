"""Placed shapes: volume, inside test, signed distance and mass, in closed form where there is one."""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.geometry.mass import MassProperties, from_covariance, mass_properties
from sim.geometry.spec import Placement, Rotation

if TYPE_CHECKING:
    import trimesh

    from sim.geometry.meshes.repair import RepairReport


UP = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class Pose:
    """World point = position + scale * rotation @ local point."""

    position: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """[m], shape [3]."""
    rotation: np.ndarray = field(default_factory=lambda: np.eye(3))
    """Proper rotation, shape [3, 3]."""
    scale: float = 1.0

    @classmethod
    def of(cls, placement: Placement) -> Pose:
        """The pose that the settings of a shape ask for."""
        return cls(np.array(placement.position), rotation_matrix(placement.rotation), float(placement.scale))

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """World coordinates [m] of local points [m], shape [n, 3]."""
        return self.scale * (points @ self.rotation.T) + self.position

    def to_local(self, points: np.ndarray) -> np.ndarray:
        """Local coordinates [m] of world points [m], shape [n, 3]."""
        return (np.asarray(points, dtype=np.float64).reshape(-1, 3) - self.position) @ self.rotation / self.scale


def rotation_matrix(turns: Sequence[Rotation]) -> np.ndarray:
    """Proper rotation that applies the turns in the order given (Rodrigues' formula), shape [3, 3]."""
    matrix = np.eye(3)
    for turn in turns:
        x, y, z = np.array(turn.axis) / np.linalg.norm(turn.axis)
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        # Quarter turns are exact, so that turned boxes stay aligned with the axes.
        quarters, rest = divmod(turn.angle, 90.0)
        exact = {0: (1.0, 0.0), 1: (0.0, 1.0), 2: (-1.0, 0.0), 3: (0.0, -1.0)}
        angle = np.deg2rad(turn.angle)
        cosine, sine = exact[int(quarters) % 4] if rest == 0 else (np.cos(angle), np.sin(angle))
        matrix = (np.eye(3) + sine * cross + (1 - cosine) * cross @ cross) @ matrix
    return matrix


def vertex_colors(mesh: trimesh.Trimesh) -> np.ndarray | None:
    """Red, green, blue and opacity of the vertices from 0 to 255, shape [n, 4]; None where they have no colours."""
    return mesh.visual.vertex_colors if mesh.visual.kind == "vertex" else None


class Solid(ABC):
    """A placed shape. All coordinates are those of the world [m]."""

    closed = True
    """Whether the shape has an inside."""
    report: RepairReport | None = None
    """What was mended in a mesh file."""

    def __init__(self, pose: Pose, mesh: trimesh.Trimesh | None):
        self.pose = pose
        self._local_mesh = mesh

    @functools.cached_property
    def mesh(self) -> trimesh.Trimesh | None:
        """The surface in world space, faces outward, in the colours of its file if it has any; None for a plane."""
        if self._local_mesh is None:
            return None
        import trimesh

        local = self._local_mesh
        vertices = self.pose.to_world(local.vertices)
        return trimesh.Trimesh(vertices, local.faces, vertex_colors=vertex_colors(local), process=False)

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
        `reach` [m]: points beyond are infinitely far, and their gradient is 0; and it looks quickly, see
        `MeshDistance.closest`.
        """
        step = 1e-6 * float(np.ptp(self.mesh.bounds, axis=0).max())
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


class _Analytic(Solid):
    """A shape with closed forms in its own frame."""

    @property
    def bounds(self) -> np.ndarray:
        half = self.pose.scale * self._half_extents()
        return np.array([self.pose.position - half, self.pose.position + half])

    @property
    def volume(self) -> float:
        return self.pose.scale**3 * self._volume()

    def signed_distance(self, points: np.ndarray) -> np.ndarray:
        return self.pose.scale * self._distance(self.pose.to_local(points))

    def mass_properties(self, density: float) -> MassProperties:
        local = self._volume() * np.diag(self._mean_squares())
        covariance = density * self.pose.scale**5 * self.pose.rotation @ local @ self.pose.rotation.T
        return from_covariance(density * self.volume, self.volume, self.pose.position, covariance)

    def _axis(self) -> np.ndarray:
        """Magnitudes of the world components of the shape's own y axis, shape [3]."""
        return np.abs(self.pose.rotation[:, 1])

    def _across(self) -> np.ndarray:
        """Half extents in the world of a unit disc normal to the shape's own y axis, shape [3]."""
        return np.sqrt(np.maximum(0.0, 1.0 - self._axis() ** 2))

    @abstractmethod
    def _half_extents(self) -> np.ndarray:
        """Half extents along the world's axes before scaling, shape [3]."""

    @abstractmethod
    def _volume(self) -> float: ...

    @abstractmethod
    def _distance(self, local: np.ndarray) -> np.ndarray: ...

    @abstractmethod
    def _mean_squares(self) -> np.ndarray:
        """Means of x^2, y^2 and z^2 over the shape, shape [3]."""


class BoxSolid(_Analytic):
    """A cuboid with edges `size` [m]."""

    def __init__(self, pose: Pose, mesh: trimesh.Trimesh, size: tuple[float, float, float]):
        super().__init__(pose, mesh)
        self.size = np.array(size, dtype=np.float64)

    def _half_extents(self) -> np.ndarray:
        return np.abs(self.pose.rotation) @ self.size / 2

    def _volume(self) -> float:
        return float(self.size.prod())

    def _distance(self, local: np.ndarray) -> np.ndarray:
        return _outside_intervals(np.abs(local) - self.size / 2)

    def _mean_squares(self) -> np.ndarray:
        return self.size**2 / 12


class SphereSolid(_Analytic):
    """A ball of `radius` [m]."""

    def __init__(self, pose: Pose, mesh: trimesh.Trimesh, radius: float):
        super().__init__(pose, mesh)
        self.radius = radius

    def _half_extents(self) -> np.ndarray:
        return np.full(3, self.radius)

    def _volume(self) -> float:
        return 4 / 3 * np.pi * self.radius**3

    def _distance(self, local: np.ndarray) -> np.ndarray:
        return np.linalg.norm(local, axis=1) - self.radius

    def _mean_squares(self) -> np.ndarray:
        return np.full(3, self.radius**2 / 5)


class CylinderSolid(_Analytic):
    """A cylinder of `radius` and `height` [m] along its own y."""

    def __init__(self, pose: Pose, mesh: trimesh.Trimesh, radius: float, height: float):
        super().__init__(pose, mesh)
        self.radius = radius
        self.height = height

    def _half_extents(self) -> np.ndarray:
        return self.height / 2 * self._axis() + self.radius * self._across()

    def _volume(self) -> float:
        return np.pi * self.radius**2 * self.height

    def _distance(self, local: np.ndarray) -> np.ndarray:
        across = np.hypot(local[:, 0], local[:, 2]) - self.radius
        return _outside_intervals(np.column_stack([across, np.abs(local[:, 1]) - self.height / 2]))

    def _mean_squares(self) -> np.ndarray:
        across = self.radius**2 / 4
        return np.array([across, self.height**2 / 12, across])


class CapsuleSolid(_Analytic):
    """A cylinder of `radius` and `height` [m] along its own y, with half-spheres on both ends."""

    def __init__(self, pose: Pose, mesh: trimesh.Trimesh, radius: float, height: float):
        super().__init__(pose, mesh)
        self.radius = radius
        self.height = height

    def _half_extents(self) -> np.ndarray:
        return self.height / 2 * self._axis() + self.radius

    def _volume(self) -> float:
        return np.pi * self.radius**2 * (self.height + 4 / 3 * self.radius)

    def _distance(self, local: np.ndarray) -> np.ndarray:
        beyond = np.maximum(np.abs(local[:, 1]) - self.height / 2, 0.0)
        return np.sqrt(local[:, 0] ** 2 + beyond**2 + local[:, 2] ** 2) - self.radius

    def _mean_squares(self) -> np.ndarray:
        r, h = self.radius, self.height
        shaft, ends = h, 4 / 3 * r  # volumes over pi r^2
        across = shaft * r**2 / 4 + ends * r**2 / 5
        # The centroid of a half-sphere is 3 r / 8 above its flat side.
        along = shaft * h**2 / 12 + ends * (r**2 / 5 + 3 / 8 * r * h + h**2 / 4)
        return np.array([across, along, across]) / (shaft + ends)


class TorusSolid(_Analytic):
    """A ring of `radius` and `tube_radius` [m] around its own y."""

    def __init__(self, pose: Pose, mesh: trimesh.Trimesh, radius: float, tube_radius: float):
        super().__init__(pose, mesh)
        self.radius = radius
        self.tube_radius = tube_radius

    def _half_extents(self) -> np.ndarray:
        return self.radius * self._across() + self.tube_radius

    def _volume(self) -> float:
        return 2 * np.pi**2 * self.radius * self.tube_radius**2

    def _distance(self, local: np.ndarray) -> np.ndarray:
        ring = np.hypot(local[:, 0], local[:, 2]) - self.radius
        return np.hypot(ring, local[:, 1]) - self.tube_radius

    def _mean_squares(self) -> np.ndarray:
        across = self.radius**2 / 2 + 3 / 8 * self.tube_radius**2
        return np.array([across, self.tube_radius**2 / 4, across])


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
        super().__init__(pose, mesh)
        self.report = report

    @property
    def bounds(self) -> np.ndarray:
        return np.array(self.mesh.bounds)

    @functools.cached_property
    def volume(self) -> float:
        from sim.geometry.meshes.topology import signed_volume

        return signed_volume(self.mesh)

    @functools.cached_property
    def _winding(self):
        from sim.geometry.meshes.winding import WindingNumber

        return WindingNumber(self.mesh)

    @functools.cached_property
    def _distance(self):
        from sim.geometry.distance.closest_points import MeshDistance

        return MeshDistance(self.mesh)

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
        foot, distance[near], face = self._distance.closest(points[near], sure=False)
        # On the surface the way from its nearest point says nothing.
        on = distance[near] < 1e-9 * float(np.ptp(self.bounds, axis=0).max())
        away = sign[near, None] * (points[near] - foot) / np.maximum(distance[near], 1e-300)[:, None]
        slope[near] = np.where(on[:, None], self.mesh.face_normals[face], away)
        return sign * distance, slope

    @functools.cached_property
    def _of_unit_density(self) -> MassProperties:
        return mass_properties(self.mesh, 1.0)

    def mass_properties(self, density: float) -> MassProperties:
        return self._of_unit_density.scaled_to(density * self._of_unit_density.volume)


class SheetSolid(Solid):
    """A surface without inside: nothing is contained, and distances are positive."""

    closed = False

    def __init__(self, pose: Pose, mesh: trimesh.Trimesh, size: tuple[float, float]):
        super().__init__(pose, mesh)
        self.size = np.array(size, dtype=np.float64)
        """Edge lengths along its own x and z before scaling [m], shape [2]."""

    @property
    def bounds(self) -> np.ndarray:
        return np.array(self.mesh.bounds)

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


def _outside_intervals(excess: np.ndarray) -> np.ndarray:
    """Signed distance to a product of intervals, from the excess over each half-length, shape [n, axes]."""
    return np.linalg.norm(np.maximum(excess, 0.0), axis=1) + np.minimum(excess.max(axis=1), 0.0)
