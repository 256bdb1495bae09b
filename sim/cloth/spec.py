"""Settings of cloth."""

from __future__ import annotations

import itertools
from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from common.registry import added, names
from scene.extra import Added, of_packages
from scene.settings import Name, Settings
from scene.units import (
    AngularVelocity,
    AreaDensity,
    Density,
    Dimensionless,
    Duration,
    Position,
    PositiveDuration,
    PositiveLength,
    PositiveSpeed,
    Unit,
    Velocity,
)
from sim.cloth import INTEGRATORS
from sim.geometry.spec import ClothShape, Placement, Rotation

Stiffness = Annotated[float, Gt(0), Le(1e12), Unit("N/m")]
ShearStiffness = Annotated[float, Ge(0), Le(1e12), Unit("N/m")]
BendStiffness = Annotated[float, Ge(0), Le(1e9), Unit("N*m")]
Ratio = Annotated[Dimensionless, Ge(0), Le(1)]
Coefficient = Annotated[Dimensionless, Ge(0), Le(100)]
Friction = Annotated[Dimensionless, Ge(0), Le(10)]
Side = Literal["corners", "left", "right", "front", "back"]


class PinKeyframe(Settings):
    """Where pinned points are at one time; they move straight and turn evenly to the next, the shorter way round."""

    at: Duration
    """Simulated time [s]."""
    offset: Position = (0.0, 0.0, 0.0)
    """From where the points were placed [m]."""
    rotation: tuple[Rotation, ...] = ()
    """Turns about the middle of the points, applied in the order given."""


class Pin(Settings):
    """Mass points that are held, or led."""

    at: Side | tuple[Position, ...]
    """A side or the corners of a sheet; or places, of which each pins the mass point that is placed next to it."""
    keyframes: tuple[PinKeyframe, ...] = ()
    """Where the points are led, sorted by time; they are at rest before the first and after the last."""
    velocity: Velocity = (0.0, 0.0, 0.0)
    """Without keyframes, that of the middle of the points, for ever [m/s]."""
    angular_velocity: AngularVelocity = (0.0, 0.0, 0.0)
    """Likewise, about that middle [rad/s]."""

    @model_validator(mode="after")
    def _is_led_one_way(self) -> Self:
        if self.keyframes and (any(self.velocity) or any(self.angular_velocity)):
            raise ValueError("keyframes exclude velocity and angular_velocity: give one of the two")
        for earlier, later in itertools.pairwise(self.keyframes):
            if later.at <= earlier.at:
                raise ValueError(f"the keyframe at {later.at:g} s follows the one at {earlier.at:g} s: sort by time")
        return self


class ClothSheet(Placement):
    """One piece of cloth: masses at points, springs between them."""

    shape: ClothShape
    spacing: PositiveLength | None = None
    """Distance of neighbouring mass points of a sheet [m], rounded so that both sides divide; by default a fortieth of
    the longer side. A mesh brings points of its own."""
    mass_per_area: AreaDensity = 0.2
    stretch_stiffness: Stiffness = 1000.0
    """Force per width and strain [N/m] of a strip that is pulled along its threads, whatever the resolution."""
    shear_stiffness: ShearStiffness | None = None
    """Force per width and angle [N/m] of a sheet; by default half of the other. A mesh of equal triangles has 3/8."""
    bend_stiffness: BendStiffness = 1e-4
    """Moment per width and curvature [N m]."""
    bend_model: Literal["dihedral", "springs"] = "dihedral"
    """Angles between triangles; or springs to the points next but one, which do not resist while the cloth is flat."""
    damping: Ratio = 0.02
    """Of each spring with the two masses at its ends, over what just keeps them from swinging."""
    bend_damping: Ratio = 0.02
    """The same of bending."""
    rest_scale: Annotated[Dimensionless, Ge(0), Le(100)] = 1.0
    """Lengths at rest over those as placed: above 1 the cloth begins loose, below 1 taut."""
    thickness: PositiveLength = 0.002
    """Distance of its middle from that of another cloth that lies on it; half of it from solids [m]. What is nearer at
    rest than twice that may come as near as half of that distance, so that cloth finer than it is thick bends."""
    friction: Friction = 0.3
    """Coefficient of Coulomb friction while sliding; of two surfaces the geometric mean counts."""
    static_friction: Friction | None = None
    """The coefficient at rest, at least that while sliding; without it, the same."""
    pins: tuple[Side | Pin, ...] = ()
    """Mass points that are held or led; an event may release them by setting other pins."""
    velocity: Velocity = (0.0, 0.0, 0.0)

    @property
    def friction_coefficients(self) -> tuple[float, float]:
        """Coefficients of friction while sliding and at rest."""
        return self.friction, self.friction if self.static_friction is None else self.static_friction

    @model_validator(mode="after")
    def _fits_its_shape(self) -> Self:
        if self.static_friction is not None and self.static_friction < self.friction:
            raise ValueError("static_friction must be at least friction: raise it, or lower friction")
        if self.shape.type == "mesh":
            for name in ("spacing", "shear_stiffness"):
                if getattr(self, name) is not None:
                    raise ValueError(f"{name} is for sheets: a mesh brings points and triangles of its own; remove it")
            sides = [pin if isinstance(pin, str) else pin.at for pin in self.pins]
            if any(isinstance(side, str) for side in sides):
                raise ValueError("a mesh has no sides or corners: give places to pin, as `at: [[x, y, z]]`")
        return self


class Air(Settings):
    """Air around the cloth, which drags on it."""

    density: Density = 1.2
    wind: Velocity = (0.0, 0.0, 0.0)
    drag: Coefficient = 1.3
    """Of what moves across the cloth: force over density/2 * area * speed^2."""
    skin_friction: Coefficient = 0.02
    """Likewise of what moves along it, both faces together."""


class ImplicitEuler(Settings):
    """Newton's method and conjugate gradients."""

    velocity_error: PositiveSpeed = 0.01
    """Newton's method ends when no velocity changes by more than this [m/s], and forces are balanced."""
    force_error: Annotated[Dimensionless, Gt(0), Le(50)] = 1e-2
    """Forces are balanced when what is left of them is, on average, this share of those that accelerate the cloth in
    the step, or of its weight. With 10, most steps are one linear solution or two."""
    max_newton: Annotated[int, Ge(1), Le(1000)] = 20
    linear_error: Annotated[Dimensionless, Gt(0), Le(0.5)] = 0.03
    """Of each linear system: residual over the first one."""
    max_iterations: Annotated[int, Ge(1), Le(100_000)] = 1000
    """Of conjugate gradients in each of Newton's steps."""


class SymplecticEuler(Settings):
    """Explicit steps, as many as stability asks for."""

    share: Annotated[Dimensionless, Gt(0), Le(1)] = 0.69
    """Length of a step over the longest stable one."""


class XPBD(Settings):
    """Small steps of extended position-based dynamics."""

    substeps: Annotated[int, Ge(1), Le(10_000)] = 10
    """In each step."""
    iterations: Annotated[int, Ge(1), Le(1000)] = 1
    """Sweeps over all springs in each of them."""


class Cloth(Settings):
    """The cloth of the scene."""

    sheets: Annotated[dict[Name, ClothSheet], Field(min_length=1)]
    integrator: Literal[(*INTEGRATORS, *names("integrators"))] = "implicit_euler"
    max_step: Annotated[PositiveDuration, Le(0.1)] = 0.005
    """Longest time step of a scene with cloth [s]."""
    air: Air | None = None
    """Without it, the cloth is in a vacuum."""
    implicit_euler: ImplicitEuler = ImplicitEuler()
    symplectic_euler: SymplecticEuler = SymplecticEuler()
    xpbd: XPBD = XPBD()
    extra: Annotated[dict[Name, Added], of_packages("integrators")] = {}
    """Settings of integrators that installed packages add, by their names."""

    @property
    def integrator_settings(self) -> Any:
        """Those of the chosen integrator."""
        if self.integrator in type(self).model_fields:
            return getattr(self, self.integrator)
        return self.extra.get(self.integrator) or added("integrators")[self.integrator]()
