"""What fluid ends flush with: plane walls, bodies and vessels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim.bodies.wall import Wall
from workflow.stages.surface.layers import Cloud
from workflow.stages.surface.mesh import Surface
from workflow.stages.surface.solids import (
    Contacts,
    Inside,
    Solid,
    contacts,
    flush_with_solids,
    gone_on,
    heights_above,
    inside,
)
from workflow.stages.surface.walls import continued, flush

ON = 1e-3
"""Vertices nearer than this to a wall are on it, in spacings."""


@dataclass(frozen=True)
class Boundary:
    """Of particles of one `spacing`."""

    walls: Sequence[Wall]
    touch: Contacts
    within: Inside
    spacing: float
    """[m]"""

    @classmethod
    def around(cls, positions: np.ndarray, walls: Sequence[Wall], solids: Sequence[Solid], spacing: float) -> Boundary:
        """Of particles at `positions` [m], shape [n, 3]."""
        points = positions.astype(np.float64)
        touch = contacts(points, solids, spacing)
        return cls(walls, touch, inside(touch, points, spacing), spacing)

    def of(self, positions: np.ndarray, particles: np.ndarray) -> Boundary:
        """That of some of the particles at `positions` [m], a mask."""
        touch = self.touch.of(particles)
        return replace(self, touch=touch, within=inside(touch, positions[particles].astype(np.float64), self.spacing))

    def continued(self, cloud: Cloud) -> Cloud:
        """The same particles, followed by those that go on behind walls and inside solids."""
        behind = continued(cloud, self.spacing, self.walls)
        return gone_on(behind, self.touch, self.within)

    def flush(self, surface: Surface, fluid: np.ndarray) -> tuple[Surface, np.ndarray]:
        """The surface around `fluid` [m], shape [n, 3], that was continued, with nothing behind walls or inside solids;
        and which of its vertices lie on these, shape [m]."""
        surface, on = flush_with_solids(flush(surface, self.walls), fluid, self.touch, self.within, self.spacing)
        for wall in self.walls:
            on |= wall.distance(surface.vertices.astype(np.float64)) < ON * self.spacing
        return surface, on

    def heights(self, surface: Surface, normal: np.ndarray, reach: float) -> np.ndarray:
        """How far vertices with unit vectors `normal` out of the fluid are above what they look away from [m], shape
        [n]; infinite beyond `reach` [m]."""
        place = surface.vertices.astype(np.float64)
        height = heights_above(place, normal, self.touch, reach)
        for wall in self.walls:
            distance = wall.distance(place)
            above = (distance < reach) & (normal @ np.array(wall.normal) > 0)
            height = np.where(above, np.minimum(height, distance), height)
        return height

    def pressed(self, place: np.ndarray) -> np.ndarray:
        """Points [m], shape [n, 3], of which those behind a wall have come to it."""
        for wall in self.walls:
            place, _ = wall.pressed(place)
        return place
