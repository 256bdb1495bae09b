"""Where a body is at one time, and how fast it moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Movement:
    """How a body has been moved since its shape was placed: the point x of the placed shape is now at
    position + rotation @ (x - pivot), and moves at velocity + angular_velocity x (where it is - position).

    World coordinates; each of shape [3], the proper rotation of shape [3, 3].
    """

    pivot: np.ndarray
    """The body's own origin as placed [m]."""
    position: np.ndarray
    """Where it is now [m]."""
    rotation: np.ndarray
    velocity: np.ndarray
    """Of the body's own origin [m/s]."""
    angular_velocity: np.ndarray
    """[rad/s]"""

    def carry(self, points: np.ndarray) -> np.ndarray:
        """Where points of the placed shape are now [m], shape [n, 3], or one of shape [3]."""
        return (points - self.pivot) @ self.rotation.T + self.position

    def carry_back(self, points: np.ndarray) -> np.ndarray:
        """Which points of the placed shape are now at these [m], shape [n, 3]."""
        return (points - self.position) @ self.rotation + self.pivot

    def velocity_at(self, points: np.ndarray) -> np.ndarray:
        """Velocity [m/s] of the body where it is at points [m] of the world now, shape [n, 3] or [3]."""
        return self.velocity + np.cross(self.angular_velocity, points - self.position)

    def quaternion(self) -> np.ndarray:
        """The rotation as w, x, y, z of unit length with w >= 0, shape [4]."""
        return quaternions([self])[0]


def quaternions(movements: Sequence[Movement]) -> np.ndarray:
    """Rotations of one or more as w, x, y, z of unit length with w >= 0, shape [n, 4]."""
    from scipy.spatial.transform import Rotation

    found = np.roll(Rotation.from_matrix([movement.rotation for movement in movements]).as_quat(), 1, axis=1)
    return found * np.where(found[:, :1] >= 0, 1.0, -1.0)
