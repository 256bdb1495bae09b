"""A force in a file of its own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from sim.device.arrays import Declared
from sim.fluid.system import FluidSystem


class Force(ABC):
    """Adds to the accelerations of all particles [m/s^2]."""

    ARRAYS: ClassVar[tuple[Declared, ...]] = ()
    """Arrays of particles that it needs."""
    BY_SOLIDS: ClassVar[bool] = False
    """Whether it is an adhesion by solids: couplings apply the opposite to them, by its strengths [m/s^2 over m^3]
    against samples of sheets and against solids."""
    samples: float = 0.0
    solids: float = 0.0

    def __init__(self, system: FluidSystem):
        self.system = system

    @classmethod
    def applies(cls, system: FluidSystem) -> bool:
        """Whether there is anything in the system that it acts on."""
        return True

    @abstractmethod
    def accelerate(self) -> None:
        """Add to the accelerations; positions, velocities, densities and neighbours are given."""
