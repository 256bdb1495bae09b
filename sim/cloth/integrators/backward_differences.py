"""The step before, for backward differences of second order (Curtiss & Hirschfelder 1952; for cloth: Choi & Ko 2002).

With r the step over the one before, a = (1 + r)^2 / (1 + 2 r) and b = r^2 / (1 + 2 r), they ask that

    x' = a x - b x_before + h v',  v' = a v - b v_before + h f(x') / m,  h = dt (1 + r) / (1 + 2 r),

which is a step of implicit Euler, h long, from a x - b x_before at the speed a v - b v_before.
"""

from __future__ import annotations

import numpy as np

from sim.cloth.fabric.arrays import filled, vectors

LONGEST = 2.0
"""Of the step before: from 1 + sqrt(2) of it on, what swings would swing more and more (Grigorieff 1983)."""


class BackwardDifferences:
    """Where points were a step ago [m], how fast they were [m/s], and how long ago that is [s]; zero: not known."""

    def __init__(self, count: int):
        self.position = vectors(np.zeros((count, 3)))
        self.velocity = vectors(np.zeros((count, 3)))
        self.step = 0.0
        self._count = count

    def serves(self, dt: float) -> bool:
        """Whether a step of dt [s] can go by it."""
        return 0.0 < dt <= LONGEST * self.step

    def weights(self, dt: float) -> tuple[float, float, float]:
        """a, b and h [s] of a step of dt [s]."""
        r = dt / self.step
        return (1 + r) ** 2 / (1 + 2 * r), r**2 / (1 + 2 * r), dt * (1 + r) / (1 + 2 * r)

    def recall(self, position: np.ndarray, velocity: np.ndarray, step: np.ndarray) -> None:
        """Go on from `arrays`."""
        if len(step):
            filled(self.position, position)
            filled(self.velocity, velocity)
            self.step = float(step[0])

    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions [m], velocities [m/s], shape [points, 3], and the step [s], shape [1]; empty where not known."""
        if not self.step:
            return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)
        return self.position.to_numpy()[: self._count], self.velocity.to_numpy()[: self._count], np.array([self.step])
