"""Which bodies are too thin for the particles around them."""

from __future__ import annotations

from collections.abc import Iterator

from sim.bodies.obstacles import Obstacle, Obstacles
from sim.geometry.distance.sdf import GRID
from sim.geometry.primitives import primitive

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""

THIN = 2.0
"""Spacings under which fluid at rest may hold a body against its weight (docs/fluids.md, Known limits)."""
THIN_MESH = 1.0
"""The same for a mesh, of which only a least thickness is known: that of a plate with its volume and surface."""


def warnings(obstacles: Obstacles, spacing: float) -> Iterator[str]:
    """One for each body that obeys forces and is thinner than the fluid's `spacing` [m] resolves."""
    for item in obstacles.dynamic.values():
        thickness, least = _thickness(item)
        if thickness < (1 - 1e-3) * least * spacing:
            spacings = "two particle spacings" if least == THIN else "a particle spacing"
            yield (
                f"'{item.name}' is {1000 * thickness:.3g} mm thick, less than {spacings}, "
                f"{1000 * least * spacing:.3g} mm: fluid may hold it where it should sink or rise; "
                f"a particle_radius of {thickness / least / 2:.3g} m would do"
            )


def _thickness(item: Obstacle) -> tuple[float, float]:
    """Of a body [m], and the least number of spacings that it should be."""
    shape = primitive(item.solid)
    if shape.kind != GRID:
        return 2.0 * float(shape.half.min()), THIN
    return 2.0 * abs(float(item.solid.volume)) / float(item.solid.surface.area), THIN_MESH
