"""Settings of rigid bodies."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from annotated_types import Ge, Le
from pydantic import Field, model_validator

from sim.geometry.spec import AnyShape, Placement, Rotation
from sim.settings import Name, Settings
from sim.units import AngularVelocity, Density, Dimensionless, Duration, Mass, Position, Velocity


class Keyframe(Settings):
    """Where a prescribed body is at one time; linear in between."""

    at: Duration
    position: Position
    rotation: tuple[Rotation, ...] = ()


class RigidBody(Placement):
    """A body that keeps its shape."""

    shape: AnyShape
    motion: Literal["static", "prescribed", "dynamic"] = "static"
    """`static` stands still, `prescribed` follows its keyframes, `dynamic` obeys forces."""
    density: Density = 1000.0
    mass: Mass | None = None
    """Instead of the density [kg]."""
    velocity: Velocity = (0.0, 0.0, 0.0)
    angular_velocity: AngularVelocity = (0.0, 0.0, 0.0)
    keyframes: tuple[Keyframe, ...] = ()
    friction: Annotated[Dimensionless, Ge(0), Le(10)] = 0.5
    """Coefficient of Coulomb friction."""
    restitution: Annotated[Dimensionless, Ge(0), Le(1)] = 0.3
    """Relative speed after an impact over the one before."""

    @model_validator(mode="after")
    def _motion_is_consistent(self) -> Self:
        if self.motion == "prescribed" and not self.keyframes:
            raise ValueError("motion: prescribed needs keyframes")
        if self.motion != "prescribed" and self.keyframes:
            raise ValueError("keyframes need motion: prescribed")
        if self.motion != "dynamic" and (any(self.velocity) or any(self.angular_velocity)):
            raise ValueError("velocity and angular_velocity need motion: dynamic")
        if self.motion != "static" and self.shape.type in {"plane", "sheet"}:
            raise ValueError(f"a {self.shape.type} can only be static")
        return self


class Rigid(Settings):
    """The rigid bodies of the scene."""

    bodies: Annotated[dict[Name, RigidBody], Field(min_length=1)]
