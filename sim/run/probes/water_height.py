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
AT_ONCE = 16
"""Heights that are looked at together."""


def read(probe: WaterHeight, view: View) -> Iterator[Row]:
    """Height of the surface [m]."""
    yield "water_height", water_height(view.fluid, probe.x, probe.z), "m"


def water_height(fluid: Particles, x: float, z: float) -> float:
    """Highest point on the vertical line where the fluid fills half of the kernel [m]; nan without fluid there.

    Heights are looked at from the top down until that is found: most of a deep column is below.
    """
    near = fluid.near_line((0, 2), (x, z)).points
    near = near[np.hypot(near[:, 0] - x, near[:, 2] - z) < fluid.h]
    if not len(near):
        return math.nan
    near = near[np.argsort(-near[:, 1], kind="stable")]
    offsets, particles = np.hypot(near[:, 0] - x, near[:, 2] - z), near[:, 1]
    heights, last = heights_from_top(particles, fluid.h), (math.nan, math.nan)
    for first in range(0, len(heights), AT_ONCE):
        y = heights[first : first + AT_ONCE]
        begin, end = np.searchsorted(-particles, [-y[0] - fluid.h, -y[-1] + fluid.h])
        apart = np.hypot(offsets[begin:end], particles[begin:end] - y[:, None])
        filled = cubic_host(apart, fluid.h).sum(axis=1) * fluid.mass / fluid.spec.rest_density
        above = np.flatnonzero(filled >= 0.5)
        if len(above):
            k = above[0]
            before = (y[k - 1], filled[k - 1]) if k else last
            share = (0.5 - before[1]) / (filled[k] - before[1])
            return float(before[0] + share * (y[k] - before[0]))
        last = y[-1], filled[-1]
    return math.nan


def heights_from_top(particles: np.ndarray, h: float) -> np.ndarray:
    """Heights [m] from the top down, h / 16 apart, without those that no particle reaches: drops may be far apart."""
    step, top = h / 16, particles.max() + h
    middle = np.unique(((top - particles) // step).astype(np.int64))
    return top - step * np.unique(middle[:, None] + np.arange(-17, 19))
