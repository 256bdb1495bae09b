"""Where a shape is placed: turned, scaled and moved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from sim.geometry.spec import Placement, Rotation


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
