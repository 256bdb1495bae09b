"""Settings of the probes that a scene may have."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from annotated_types import Ge
from pydantic import Field, model_validator

from common.registry import added
from scene.settings import Name, Settings, type_names
from scene.units import Length, Position
from sim.run.probes.probe import ProbeSettings


class WaterHeight(ProbeSettings):
    """Height of the fluid's surface above a point of the ground plane [m]."""

    IMPLEMENTATION: ClassVar[str] = "sim.run.probes.water_height:read"
    MATERIAL: ClassVar[str | None] = "fluid"
    type: Literal["water_height"]
    x: Length
    """Position of the vertical line [m]."""
    z: Length = 0.0
    """Position of the vertical line [m]."""


class Pressure(ProbeSettings):
    """Pressure of the fluid at a point [Pa]; beside a solid, the pressure on it there."""

    IMPLEMENTATION: ClassVar[str] = "sim.run.probes.pressure:read"
    MATERIAL: ClassVar[str | None] = "fluid"
    PRESSURES: ClassVar[bool] = True
    type: Literal["pressure"]
    at: Position
    mean: bool = False
    """Each row is the mean since the previous one instead of an instantaneous value: peaks are filtered."""


class Front(ProbeSettings):
    """How far the fluid reaches along an axis [m]."""

    IMPLEMENTATION: ClassVar[str] = "sim.run.probes.front:read"
    MATERIAL: ClassVar[str | None] = "fluid"
    type: Literal["front"]
    axis: Literal["x", "y", "z", "-x", "-y", "-z"]


class Volume(ProbeSettings):
    """Volume of the fluid, each particle at its own density [m^3]."""

    IMPLEMENTATION: ClassVar[str] = "sim.run.probes.volume:read"
    MATERIAL: ClassVar[str | None] = "fluid"
    type: Literal["volume"]


class Region(Settings):
    """An axis-aligned box."""

    low: Position
    high: Position

    @model_validator(mode="after")
    def _is_a_box(self) -> Self:
        if not all(a < b for a, b in zip(self.low, self.high, strict=True)):
            raise ValueError("low must be below high along each axis: swap them")
        return self


class BodyForce(ProbeSettings):
    """Force [N] and torque about the centre of mass [N m] of the fluid on a rigid body."""

    IMPLEMENTATION: ClassVar[str] = "sim.run.probes.force:read"
    MATERIAL: ClassVar[str | None] = "fluid"
    type: Literal["force"]
    body: Name
    region: Region | None = None
    """Only the force on the part of the surface that is inside at the time of the row."""
    mean: bool = False
    """Each row is the mean since the previous one instead of an instantaneous value; the impulse since the start [N
    s] is recorded, too."""


class VertexPosition(ProbeSettings):
    """Position of a vertex of a cloth sheet [m]."""

    IMPLEMENTATION: ClassVar[str] = "sim.run.probes.vertex:read"
    MATERIAL: ClassVar[str | None] = "cloth"
    type: Literal["vertex"]
    sheet: Name
    vertex: Annotated[int, Ge(0)]


class PinForce(ProbeSettings):
    """Force of all pins of a cloth sheet on it [N]."""

    IMPLEMENTATION: ClassVar[str] = "sim.run.probes.pin_force:read"
    MATERIAL: ClassVar[str | None] = "cloth"
    type: Literal["pin_force"]
    sheet: Name


OWN = (WaterHeight, Pressure, Front, Volume, BodyForce, VertexPosition, PinForce)
PROBES = (*OWN, *added("probes", *type_names(*OWN)).values())
"""Those of Tidemill, and what installed packages add."""

if TYPE_CHECKING:
    Probe = Any
else:
    Probe = Annotated[reduce(or_, PROBES), Field(discriminator="type")]
