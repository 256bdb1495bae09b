"""Bodies and cloth that fluid moves at once."""

from __future__ import annotations

from collections.abc import Sequence

from sim.fluid.forces.momentum import Momentum
from sim.fluid.system import Bodies

MATERIALS = ("fluid", "rigid", "cloth")
"""Of a scene, for this to be loaded."""


class Together:
    """Several that the fluid moves, as `system.bodies`: each is asked in turn, the one that begins sums first."""

    def __init__(self, parts: Sequence[Bodies]):
        self.parts = parts
        self.lightness = max(part.lightness for part in parts)

    def list(self) -> None:
        for part in self.parts:
            part.list()

    def hear(self, momentum: Momentum) -> None:
        for part in self.parts:
            part.hear(momentum)

    def foresee(self, dt: float) -> None:
        for part in self.parts:
            part.foresee(dt)

    def expect(self, dt: float) -> None:
        for part in self.parts:
            part.expect(dt)

    def answer(self, ahead: float, *, beside_expected: bool = False) -> None:
        for part in self.parts:
            part.answer(ahead, beside_expected=beside_expected)

    def press(self, ahead: float) -> None:
        for part in self.parts:
            part.press(ahead)

    def take(self, dt: float) -> None:
        for part in self.parts:
            part.take(dt)

    def hold(self, dt: float) -> None:
        for part in self.parts:
            part.hold(dt)

    def undo(self, dt: float) -> None:
        for part in self.parts:
            part.undo(dt)

    def settle(self, dt: float) -> dict[str, float]:
        told = {}
        for part in self.parts:
            told |= part.settle(dt)
        return told

    def drift(self, dt: float) -> dict[str, float]:
        told = {}
        for part in self.parts:
            told |= part.drift(dt)
        return told

    def strike(self, dt: float, momentum: Momentum) -> None:
        for part in self.parts:
            part.strike(dt, momentum)

    def hold_off(self, dt: float) -> None:
        for part in self.parts:
            part.hold_off(dt)

    @property
    def bytes(self) -> int:
        return sum(part.bytes for part in self.parts)
