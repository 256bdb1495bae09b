"""What the sheets of a scene do at one time."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass
class ClothState:
    """Points of all sheets, one sheet after the other."""

    sheets: dict[str, int] = field(default_factory=dict)
    """How many points each has."""
    position: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """[m]"""
    velocity: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """[m/s]"""
    touch_key: np.ndarray = field(default_factory=lambda: np.zeros((0, 5), np.int32))
    """Contacts of the last step: kind and four points."""
    touch_weight: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    touch_normal: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    touch_force: np.ndarray = field(default_factory=lambda: np.zeros((0, 5)))
    """Limits [m], and forces along the normal and across [N]."""
    fluid_force: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """On points, in the last step [N]."""

    past_position: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Of points a step before [m], where integrators go by it."""
    past_velocity: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """[m/s]"""
    past_step: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """How long before that was [s], shape [1], or [0] where there is none."""

    def without_contacts(self) -> ClothState:
        """Without the step before, too, which was one of other cloth."""
        return ClothState(self.sheets, self.position, self.velocity, fluid_force=self.fluid_force)

    def of(self, name: str) -> tuple[np.ndarray, np.ndarray] | None:
        """Positions and velocities of one sheet, if it is there."""
        start = 0
        for sheet, count in self.sheets.items():
            if sheet == name:
                return self.position[start : start + count], self.velocity[start : start + count]
            start += count
        return None
