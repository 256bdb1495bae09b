"""A world as probes see it: arrays on the host, double precision, world coordinates."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import given

if TYPE_CHECKING:
    from sim.run.world import World


class Particles:
    """Those of the fluid.

    `points` [m] and `velocity` [m/s], shape [n, 3]; `density` [kg/m^3] and `pressure` of the last step [Pa], shape [n];
    `mass` of each [kg]; `h`, the kernel's support radius [m]; `spec`, the fluid's settings.
    """

    def __init__(self, world: World):
        model = given(world.fluid)
        state = model.state()
        self.h = model.system.h
        self.mass = model.system.mass
        self.spec = model.system.spec
        self.points = state.position[:, :3].astype(np.float64) + world.origin
        self.velocity = state.velocity[:, :3].astype(np.float64)
        self.density = state.velocity[:, 3].astype(np.float64)
        self.pressure = model.system.pressures() * self.density**2


class View:
    """The `world` at `time` [s], as one probe after another looks at it."""

    def __init__(self, world: World, time: float):
        self.world = world
        self.time = time

    @cached_property
    def fluid(self) -> Particles:
        """The particles, brought over from the device once for all probes."""
        return Particles(self.world)

    def has_sheet(self, name: str) -> bool:
        """Whether a sheet is there now."""
        return any(item.name == name for item in self.world.sheets)
