"""Zones of impact: points that would pass one another go on more and more as one (Provot 1997, Bridson et al. 2002).

What moves as one passes through nothing of itself. The mean displacement of a zone, weighed by mass, stays: so does its
momentum. A zone that a solid, a held point or a plane is part of goes where that goes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sim.geometry.components import groups


@dataclass
class ImpactZones:
    """Pairs that would have passed in this step: points, shape [pairs, 4], -1 for none. `mass`: of points [kg], 0 for
    those that are fixed to something, shape [points]."""

    mass: np.ndarray
    pairs: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), np.int32))

    def add(self, pairs: np.ndarray) -> np.ndarray:
        """Let pairs belong together; returns the number of its zone for each point, -1 outside of those that one of
        these pairs is in, shape [points]."""
        self.pairs = np.unique(np.concatenate([self.pairs, pairs]), axis=0)
        first, other = np.repeat(self.pairs[:, 0], 3), self.pairs[:, 1:].ravel()
        both = (first >= 0) & (other >= 0)
        _, zone = groups(first[both], other[both], len(self.mass))
        chosen = np.isin(zone, zone[pairs[pairs >= 0]])
        return np.where(chosen, zone, -1)

    def join(self, zone: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Displacements or velocities of points, shape [points, 3], half as far from the mean of their zone."""
        inside = np.flatnonzero(zone >= 0)
        name, zone = np.unique(zone[inside], return_inverse=True)
        mass, free = self.mass[inside], self.mass[inside] > 0
        fixed = np.bincount(zone, ~free, len(name)) > 0
        weight = np.where(fixed[zone], ~free, mass)
        total = np.bincount(zone, weight, len(name))[:, None]
        mean = np.column_stack([np.bincount(zone, weight * one, len(name)) for one in values[inside].T]) / total
        joined = values.copy()
        joined[inside[free]] = 0.5 * (values[inside[free]] + mean[zone[free]])
        return joined
