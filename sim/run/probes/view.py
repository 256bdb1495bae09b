"""A world as probes see it: arrays on the host, double precision, world coordinates."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import given

if TYPE_CHECKING:
    from sim.fluid.system import FluidSystem
    from sim.run.world import World


class Particles:
    """Those of the fluid, or some of them, brought over from the device when they are first asked for.

    `points` [m] and `velocity` [m/s], shape [n, 3]; `density` [kg/m^3] and `pressure` of the last step [Pa], shape [n];
    `mass` of each [kg]; `h`, the kernel's support radius [m]; `spec`, the fluid's settings.
    """

    def __init__(self, system: FluidSystem, origin: np.ndarray, some: tuple[Particles, np.ndarray] | None = None):
        """origin: where the coordinates of the system start [m], shape [3]; some: others, and which of them."""
        self._system, self._origin, self._some = system, origin, some
        self.h = system.h
        self.mass = system.mass
        self.spec = system.spec

    def near_line(self, axes: tuple[int, int], at: tuple[float, float]) -> Particles:
        """Those within h of a line along the third axis, or a little further; `at`: where it is along `axes` [m]."""
        found = np.arange(len(self._position))
        for axis, place in zip(axes, at, strict=True):
            found = found[np.abs(self._position[found, axis] - (place - self._origin[axis])) < 1.01 * self.h]
        return Particles(self._system, self._origin, (self, found))

    @cached_property
    def points(self) -> np.ndarray:
        """Where particles are [m]."""
        return self._position[:, :3].astype(np.float64) + self._origin

    @cached_property
    def velocity(self) -> np.ndarray:
        """[m/s]."""
        return self._velocity[:, :3].astype(np.float64)

    @cached_property
    def density(self) -> np.ndarray:
        """[kg/m^3]."""
        return self._velocity[:, 3].astype(np.float64)

    @cached_property
    def pressure(self) -> np.ndarray:
        """Of the last step [Pa]."""
        from sim.fluid.layout import Q

        return self._position[:, Q].astype(np.float64) * self.density**2

    @cached_property
    def _position(self) -> np.ndarray:
        if self._some:
            return self._some[0]._position[self._some[1]]
        return self._system.particles.numpy("position")

    @cached_property
    def _velocity(self) -> np.ndarray:
        if self._some:
            return self._some[0]._velocity[self._some[1]]
        return self._system.particles.numpy("velocity")


class View:
    """The `world` at `time` [s], as one probe after another looks at it."""

    def __init__(self, world: World, time: float):
        self.world = world
        self.time = time

    @cached_property
    def fluid(self) -> Particles:
        """The particles, the same for all probes."""
        return Particles(given(self.world.fluid).system, self.world.origin)

    def has_sheet(self, name: str) -> bool:
        """Whether a sheet is there now."""
        return any(item.name == name for item in self.world.sheets)
