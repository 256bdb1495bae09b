"""Settings of cloth."""

from __future__ import annotations

from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le
from pydantic import Field

from sim.geometry.spec import ClothShape, Placement
from sim.settings import Name, Settings
from sim.units import AreaDensity, Dimensionless, PositiveLength, Unit, Velocity

Stiffness = Annotated[float, Gt(0), Unit("N/m")]
BendStiffness = Annotated[float, Ge(0), Unit("N*m")]


class ClothSheet(Placement):
    """One piece of cloth."""

    shape: ClothShape
    spacing: PositiveLength
    """Distance of neighbouring mass points [m]."""
    mass_per_area: AreaDensity = 0.2
    stretch_stiffness: Stiffness = 1000.0
    """Force per width and strain [N/m], whatever the resolution."""
    shear_stiffness: Stiffness = 500.0
    bend_stiffness: BendStiffness = 1e-4
    damping: Annotated[Dimensionless, Ge(0), Le(1)] = 0.02
    """Damping ratio of the stretch springs."""
    thickness: PositiveLength = 0.002
    friction: Annotated[Dimensionless, Ge(0), Le(10)] = 0.3
    pins: tuple[Literal["corners", "left", "right", "front", "back"], ...] = ()
    """Which mass points are held."""
    velocity: Velocity = (0.0, 0.0, 0.0)


class Cloth(Settings):
    """The cloth of the scene."""

    sheets: Annotated[dict[Name, ClothSheet], Field(min_length=1)]
    integrator: Literal["symplectic_euler", "implicit_euler", "xpbd"] = "implicit_euler"
