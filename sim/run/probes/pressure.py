"""Pressure of the fluid at a point."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scene.settings import given
from sim.coupling.pressure_at import pressure_at
from sim.run.probes.probe import Row
from sim.run.probes.spec import Pressure
from sim.run.probes.view import View

MATERIALS = ("fluid",)


def read(probe: Pressure, view: View) -> Iterator[Row]:
    """Pressure at the point [Pa]."""
    near = view.fluid.near_line((0, 1), probe.at[:2])
    pressure = pressure_at(near, given(view.world.fluid).system, view.world.origin, np.array(probe.at))
    yield "pressure", pressure, "Pa"
