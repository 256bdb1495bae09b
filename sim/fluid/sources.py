"""Particles of fluid bodies at the start, or when an event adds one."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.fluid.spec import Fluid, FluidBody
from sim.geometry.sampling import sample_volume
from sim.geometry.shapes import place
from sim.geometry.solids import Solid
from sim.settings import Refused


@dataclass(frozen=True)
class Source:
    """One fluid body: where it is, and how fast [m/s] all of it moves at first."""

    name: str
    location: tuple[str | int, ...]
    solid: Solid
    velocity: np.ndarray
    spacing: float

    @property
    def bounds(self) -> np.ndarray:
        """Box around it [m], shape [2, 3]."""
        return np.asarray(self.solid.bounds)

    @functools.cached_property
    def points(self) -> np.ndarray:
        """Its particles on a lattice [m], shape [n, 3]; raises Refused where not one fits in."""
        try:
            return sample_volume(self.solid, self.spacing)
        except Refused as refused:
            raise refused.at(*self.location, "shape") from None


def find_source(name: str, body: FluidBody, fluid: Fluid, folder: Path, location: tuple[str | int, ...]) -> Source:
    """Place a fluid body; raises Refused for a bad shape or more particles than the scene allows."""
    try:
        solid = place(body.shape, body, folder)
    except Refused as refused:
        raise refused.at(*location) from None
    if solid.volume / fluid.spacing**3 > fluid.max_particles:
        radius = (solid.volume / fluid.max_particles) ** (1 / 3) / 2
        raise Refused(
            f"'{name}' would need about {solid.volume / fluid.spacing**3:,.0f} particles, more than "
            f"fluid.max_particles = {fluid.max_particles:,}",
            location=location,
            remedy=f"use a particle_radius above {radius:.3g} m, or raise the limit",
        )
    return Source(name, location, solid, np.array(body.velocity), fluid.spacing)
