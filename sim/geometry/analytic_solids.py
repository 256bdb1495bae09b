"""Placed shapes with closed forms: box, sphere, cylinder, capsule, torus."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable

import numpy as np

from sim.geometry.mass import MassProperties, from_covariance
from sim.geometry.pose import Pose
from sim.geometry.solids import Solid
from sim.geometry.triangles import Triangles


class AnalyticSolid(Solid):
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


class BoxSolid(AnalyticSolid):
    """A cuboid with edges `size` [m]."""

    def __init__(self, pose: Pose, local: Callable[[], Triangles], size: tuple[float, float, float]):
        super().__init__(pose, local)
        self.size = np.array(size, dtype=np.float64)

    def _half_extents(self) -> np.ndarray:
        return np.abs(self.pose.rotation) @ self.size / 2

    def _volume(self) -> float:
        return float(self.size.prod())

    def _distance(self, local: np.ndarray) -> np.ndarray:
        return _outside_intervals(np.abs(local) - self.size / 2)

    def _mean_squares(self) -> np.ndarray:
        return self.size**2 / 12


class SphereSolid(AnalyticSolid):
    """A ball of `radius` [m]."""

    def __init__(self, pose: Pose, local: Callable[[], Triangles], radius: float):
        super().__init__(pose, local)
        self.radius = radius

    def _half_extents(self) -> np.ndarray:
        return np.full(3, self.radius)

    def _volume(self) -> float:
        return 4 / 3 * np.pi * self.radius**3

    def _distance(self, local: np.ndarray) -> np.ndarray:
        return np.linalg.norm(local, axis=1) - self.radius

    def _mean_squares(self) -> np.ndarray:
        return np.full(3, self.radius**2 / 5)


class CylinderSolid(AnalyticSolid):
    """A cylinder of `radius` and `height` [m] along its own y."""

    def __init__(self, pose: Pose, local: Callable[[], Triangles], radius: float, height: float):
        super().__init__(pose, local)
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


class CapsuleSolid(AnalyticSolid):
    """A cylinder of `radius` and `height` [m] along its own y, with half-spheres on both ends."""

    def __init__(self, pose: Pose, local: Callable[[], Triangles], radius: float, height: float):
        super().__init__(pose, local)
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


class TorusSolid(AnalyticSolid):
    """A ring of `radius` and `tube_radius` [m] around its own y."""

    def __init__(self, pose: Pose, local: Callable[[], Triangles], radius: float, tube_radius: float):
        super().__init__(pose, local)
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


def _outside_intervals(excess: np.ndarray) -> np.ndarray:
    """Signed distance to a product of intervals, from the excess over each half-length, shape [n, axes]."""
    return np.linalg.norm(np.maximum(excess, 0.0), axis=1) + np.minimum(excess.max(axis=1), 0.0)
