"""What is solid around a cloth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Wall:
    """The half-space n.x < offset, and its coefficients of friction."""

    normal: np.ndarray
    offset: float
    kinetic_friction: float
    static_friction: float


@dataclass(frozen=True)
class Solids:
    """Surfaces of solids as one mesh, and walls."""

    points: np.ndarray
    """Where they begin [m], shape [n, 3]."""
    made: np.ndarray
    """Where their shapes have them before anything moves [m], shape [n, 3]: what follows from that is the same to the
    bit in a run that goes on from a state."""
    triangles: np.ndarray
    """Shape [t, 3]."""
    kinetic_friction: np.ndarray
    """Coefficients of friction at points while sliding, shape [n]."""
    static_friction: np.ndarray
    """At rest, shape [n]."""
    body: np.ndarray
    """Numbers of the bodies that points belong to, shape [n]."""
    walls: list[Wall]
    names: list[str]
    """Of the bodies."""
    wall_names: list[str]
    """Of what the walls belong to."""
    dynamic: list[int]
    """Numbers of the bodies that obey forces."""
    filled: list[int]
    """Numbers of the bodies that have an inside in which nothing can be."""

    @classmethod
    def none(cls) -> Solids:
        """Where nothing is solid."""
        none = np.zeros(0)
        return cls(
            np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), int), none, none, np.zeros(0, int), [], [], [], [], []
        )
