"""Height of the fluid's surface above a point of the ground plane."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sim.fluid.kernel import cubic_host
from sim.run.probes.probe import Row
from sim.run.probes.spec import WaterHeight
from sim.run.probes.view import Particles, View

MATERIALS = ("fluid",)


def read(probe: WaterHeight, view: View) -> Iterator[Row]:
    """Height of the surface [m]."""
    yield "water_height", water_height(view.fluid, probe.x, probe.z), "m"


def water_height(fluid: Particles, x: float, z: float) -> float:
    """Highest point on the vertical line where the fluid fills half of the kernel [m]; nan without fluid there."""
    across = np.hypot(fluid.points[:, 0] - x, fluid.points[:, 2] - z)
    near = fluid.points[across < fluid.h]
    if not len(near):
        return math.nan
    volume = fluid.mass / fluid.spec.rest_density
    heights = heights_from_top(near[:, 1], fluid.h)
    offsets = np.hypot(near[:, 0] - x, near[:, 2] - z)
    filled = np.array([cubic_host(np.hypot(offsets, near[:, 1] - y), fluid.h).sum() for y in heights]) * volume
    above = np.flatnonzero(filled >= 0.5)
    if not len(above) or above[0] == 0:
        return math.nan
    k = above[0]
    share = (0.5 - filled[k - 1]) / (filled[k] - filled[k - 1])
    return float(heights[k - 1] + share * (heights[k] - heights[k - 1]))


def heights_from_top(particles: np.ndarray, h: float) -> np.ndarray:
    """Heights [m] from the top down, h / 16 apart, without those that no particle reaches: drops may be far apart."""
    step, top = h / 16, particles.max() + h
    middle = np.unique(((top - particles) // step).astype(np.int64))
    return top - step * np.unique(middle[:, None] + np.arange(-17, 19))
