"""Particles of fluid bodies at the start, or when an event adds one."""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scene.settings import Refused
from sim.fluid.spec import Fluid, FluidBody
from sim.geometry.filling import fill
from sim.geometry.shapes import place
from sim.geometry.solids import Solid

FAR_TOO_MANY = 1e9
"""Particles that are rather a slip of units than a wish."""
LOOKED_AT = 1000
"""Particles of a body of which the depth is found."""


@dataclass(frozen=True)
class VelocityField:
    """v(x) = velocity + gradient (x - middle): [m/s], shape [3]; [1/s], shape [3, 3]; [m], shape [3]."""

    velocity: np.ndarray
    gradient: np.ndarray
    middle: np.ndarray

    @classmethod
    def of(cls, body: FluidBody) -> VelocityField:
        """The initial flow of a fluid body: a spin is the antisymmetric part of a gradient."""
        spin = np.cross(np.eye(3), body.angular_velocity)
        return cls(np.array(body.velocity), np.array(body.velocity_gradient) + spin, np.array(body.position))

    def at(self, points: np.ndarray) -> np.ndarray:
        """Velocities [m/s] at points [m], both of shape [n, 3]."""
        return self.velocity + (points - self.middle) @ self.gradient.T


@dataclass(frozen=True)
class Source:
    """One fluid body: where it is, and how it flows at first."""

    name: str
    location: tuple[str | int, ...]
    solid: Solid
    flow: VelocityField
    relaxed: bool
    """Whether its particles begin without a lattice."""
    spacing: float

    @property
    def bounds(self) -> np.ndarray:
        """Box around it [m], shape [2, 3]."""
        return np.asarray(self.solid.bounds)

    @property
    def speed(self) -> float:
        """The greatest speed [m/s] in its box, which is that of a corner."""
        corners = np.array(list(itertools.product(*self.bounds.T)))
        return float(np.linalg.norm(self.flow.at(corners), axis=1).max())

    @functools.cached_property
    def points(self) -> np.ndarray:
        """Its particles if nothing is in the way [m], shape [n, 3]; raises Refused where not one fits in."""
        try:
            if self.relaxed:
                from sim.fluid.seeding.packing import fill_relaxed

                return fill_relaxed(self.solid, self.spacing)
            return fill(self.solid, self.spacing)
        except Refused as refused:
            raise refused.at(*self.location, "shape") from None

    @functools.cached_property
    def thickness(self) -> float:
        """Twice the depth of the deepest place at its particles and halfway to their neighbours [m]."""
        some = self.points[:: -(-len(self.points) // LOOKED_AT)]
        halfway = self.spacing / 2 * np.concatenate((np.zeros((1, 3)), np.eye(3), -np.eye(3)))
        return -2 * float(self.solid.signed_distance((some[:, None] + halfway).reshape(-1, 3)).min())


def _is_relaxed(body: FluidBody) -> bool:
    if body.packing == "auto":
        return body.shape.type not in ("box", "cylinder")
    return body.packing == "relaxed"


def find_source(name: str, body: FluidBody, fluid: Fluid, folder: Path, location: tuple[str | int, ...]) -> Source:
    """Place a fluid body; raises Refused for a bad shape or more particles than the scene allows."""
    try:
        solid = place(body.shape, body, folder)
    except Refused as refused:
        raise refused.at(*location) from None
    number = solid.volume / fluid.spacing**3
    if number > fluid.max_particles:
        radius = (solid.volume / fluid.max_particles) ** (1 / 3) / 2
        meant = "; plain numbers are metres, millimetres are written as 300 mm" if number > FAR_TOO_MANY else ""
        raise Refused(
            f"'{name}' would need about {number:,.0f} particles, more than "
            f"fluid.max_particles = {fluid.max_particles:,}",
            location=location,
            remedy=f"use a particle_radius above {radius:.3g} m, or raise the limit{meant}",
        )
    return Source(name, location, solid, VelocityField.of(body), _is_relaxed(body), fluid.spacing)
