"""Bodies and cloth that fluid moves at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.fluid.forces.terms import Terms
from sim.fluid.protocols import Bodies

MATERIALS = ("fluid", "rigid", "cloth")
"""Of a scene, for this to be loaded."""


class Together:
    """Several that the fluid moves, as `system.bodies`: each is asked in turn, the one that begins sums first."""

    def __init__(self, parts: Sequence[Bodies]):
        self.parts = parts
        self.layer_mass_ratio = max(part.layer_mass_ratio for part in parts)

    def list(self) -> None:
        for part in self.parts:
            part.list()

    def gather_forces(self, terms: Terms) -> None:
        for part in self.parts:
            part.gather_forces(terms)

    def predict(self, dt: float) -> None:
        for part in self.parts:
            part.predict(dt)

    def subtract_predicted(self, dt: float) -> None:
        for part in self.parts:
            part.subtract_predicted(dt)

    def respond(self, ahead: float, *, beside_expected: bool = False) -> None:
        for part in self.parts:
            part.respond(ahead, beside_expected=beside_expected)

    def gather_pressures(self, ahead: float) -> None:
        for part in self.parts:
            part.gather_pressures(ahead)

    def viscous_drag(self) -> None:
        """Implicit viscosity is refused beside cloth."""

    def apply_viscosity(self, dt: float, change: np.ndarray) -> None:
        """Likewise."""

    def apply(self, dt: float) -> None:
        for part in self.parts:
            part.apply(dt)

    def hold_along_surfaces(self, dt: float) -> None:
        for part in self.parts:
            part.hold_along_surfaces(dt)

    def revert(self, dt: float) -> None:
        for part in self.parts:
            part.revert(dt)

    def commit(self, dt: float) -> dict[str, float]:
        stats: dict[str, float] = {}
        for part in self.parts:
            stats |= part.commit(dt)
        return stats

    def drift(self, dt: float) -> dict[str, float]:
        stats: dict[str, float] = {}
        for part in self.parts:
            stats |= part.drift(dt)
        return stats

    def kick(self, dt: float, terms: Terms) -> None:
        for part in self.parts:
            part.kick(dt, terms)

    def prevent_penetration(self, dt: float) -> None:
        for part in self.parts:
            part.prevent_penetration(dt)

    @property
    def bytes(self) -> int:
        return sum(part.bytes for part in self.parts)
