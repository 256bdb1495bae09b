"""Motion of a body that obeys forces: it is where the last step has left it."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from sim.bodies.movement import Movement


class Dynamic:
    """The motion of one body with `motion: dynamic`.

    start: where it is placed, and how fast it is then; turn: the rotation of its own axes as placed, shape [3, 3].
    """

    obeys_forces: Literal[True] = True

    def __init__(self, start: Movement, turn: np.ndarray):
        self.turn = turn
        self.pivot = start.pivot
        """Its centre of mass as placed [m], shape [3]."""
        self.start = start
        self.now = start
        """Kept up to date by who steps."""

    def at(self, time: float) -> Movement:
        """Where it is; the future is not known."""
        return self.now

    def resume(self, position: np.ndarray, quaternion: np.ndarray) -> None:
        """Stand with the centre of mass at `position` [m] and the own axes turned by a unit quaternion w, x, y, z."""
        w, x, y, z = quaternion
        rotation = Rotation.from_quat([x, y, z, w]).as_matrix() @ self.turn.T
        self.now = Movement(self.pivot, position, rotation, np.zeros(3), np.zeros(3))

    def next_keyframe(self, time: float) -> float:
        """Infinite: no keyframe changes its velocities."""
        return math.inf

    def fastest(self, reach: float) -> float:
        """Speed [m/s] at the start within `reach` [m] of the centre of mass: what forces make of it is not known."""
        return float(np.linalg.norm(self.start.velocity) + reach * np.linalg.norm(self.start.angular_velocity))

    def sweep(self, points: np.ndarray) -> np.ndarray:
        """Box [m], shape [2, 3], around points of the placed shape [m], shape [n, 3], as it is placed."""
        return np.array([points.min(axis=0), points.max(axis=0)])
