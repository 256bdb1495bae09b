"""How far the fluid reaches along an axis."""

from __future__ import annotations

import math
from collections.abc import Iterator

from sim.run.probes.probe import Row
from sim.run.probes.spec import Front
from sim.run.probes.view import Particles, View

MATERIALS = ("fluid",)


def read(probe: Front, view: View) -> Iterator[Row]:
    """Reach along the axis [m]."""
    yield "front", front(view.fluid, probe.axis), "m"


def front(fluid: Particles, axis: str) -> float:
    """Furthest particle's surface along the axis [m]; negative axes measure downwards along it."""
    if not len(fluid.points):
        return math.nan
    along = fluid.points[:, "xyz".index(axis[-1])]
    radius = fluid.spec.particle_radius
    return float(along.min() - radius) if axis.startswith("-") else float(along.max() + radius)
