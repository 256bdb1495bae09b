"""A plane wall as jobs after the simulation get to know it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scene.settings import Settings
from scene.units import Direction, Length

if TYPE_CHECKING:
    import numpy as np


class Wall(Settings):
    """Nothing is where x . normal is below `offset`."""

    normal: Direction
    """Unit vector into the room."""
    offset: Length

    def distance(self, position: np.ndarray) -> np.ndarray:
        """Of points [m], shape [n, 3], negative behind the wall [m]; shape [n]."""
        return position @ self.normal - self.offset

    def pressed(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points [m], shape [n, 3], of which those behind the wall have come to it, and which those are, shape [n]."""
        distance = self.distance(position)
        behind = distance < 0
        return position - (distance * behind)[:, None] * self.normal, behind
