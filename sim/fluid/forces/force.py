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

    def __init__(self, system: FluidSystem):
        self.system = system

    @classmethod
    def applies(cls, system: FluidSystem) -> bool:
        """Whether there is anything in the system that it acts on."""
        return True

    @abstractmethod
    def accelerate(self) -> None:
        """Add to the accelerations; positions, velocities, densities and neighbours are given."""


class ForceBySolids(Force):
    """One that solids exert, so that couplings return it to them."""

    samples: float
    """Its strength against samples of sheets."""
    solids: float
    """Its strength against other solids."""
