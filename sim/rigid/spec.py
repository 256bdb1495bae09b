"""Settings of rigid bodies."""

from __future__ import annotations

import itertools
from typing import Annotated, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from scene.settings import Name, Settings
from scene.units import (
    AngularVelocity,
    Density,
    Dimensionless,
    Duration,
    Force,
    Mass,
    Position,
    PositiveDuration,
    Speed,
    Torque,
    Velocity,
)
from sim.geometry.spec import AnyShape, Placement, Rotation

Friction = Annotated[Dimensionless, Ge(0), Le(10)]
Restitution = Annotated[Dimensionless, Ge(0), Le(1)]


class Keyframe(Settings):
    """The pose of a prescribed body at one time; it moves to the next in a straight line and at a constant rate of
    rotation, the shorter way round."""

    at: Duration
    """Simulated time [s]."""
    position: Position
    """Position of the body's own origin at that time [m], like `position` of a static body."""
    rotation: tuple[Rotation, ...] | None = None
    """Rotations, applied in the order given, instead of the body's own `rotation`, which is the default."""


class Contact(Settings):
    """How a surface holds and throws back the bodies that meet it."""

    friction: Friction = 0.5
    """Coefficient of Coulomb friction while sliding; a contact uses the geometric mean of both surfaces."""
    static_friction: Friction | None = None
    """The coefficient at rest, at least that while sliding, which is the default."""
    restitution: Restitution = 0.3
    """Relative speed after an impact over that before; a contact uses the greater of both surfaces."""

    @property
    def friction_coefficients(self) -> tuple[float, float]:
        """Coefficients of friction while sliding and at rest."""
        return self.friction, self.friction if self.static_friction is None else self.static_friction

    @model_validator(mode="after")
    def _rest_holds_better(self) -> Self:
        if self.static_friction is not None and self.static_friction < self.friction:
            raise ValueError("static_friction must be at least friction: raise it, or lower friction")
        return self


class Pull(Settings):
    """A critically damped spring on the centre of mass of a dynamic body, like a hand that guides it."""

    to: Position
    """Position of its other end [m]."""
    period: Annotated[PositiveDuration, Ge(0.01), Le(100)] = 0.2
    """Undamped period of the spring with the body's mass [s]."""


class RigidBody(Placement, Contact):
    """A body that does not deform."""

    shape: AnyShape
    motion: Literal["static", "prescribed", "dynamic"] = "static"
    """`static` does not move, `prescribed` follows its keyframes or velocities, `dynamic` obeys forces."""
    density: Density = 1000.0
    mass: Mass | None = None
    """Instead of the density [kg]."""
    velocity: Velocity = (0.0, 0.0, 0.0)
    """Initial velocity of a dynamic body; constant velocity of the origin of a prescribed one without keyframes
    [m/s]."""
    angular_velocity: AngularVelocity = (0.0, 0.0, 0.0)
    """Likewise [rad/s]: a prescribed body spins about its own origin."""
    start: Duration | None = None
    """When a prescribed body without keyframes starts to move [s]; by default at 0, or when an event adds it."""
    keyframes: tuple[Keyframe, ...] = ()
    """Poses of a prescribed body, sorted by time; it is at rest before the first and after the last."""
    force: Force = (0.0, 0.0, 0.0)
    """Constant force on the centre of mass of a dynamic body; events may change it [N]."""
    torque: Torque = (0.0, 0.0, 0.0)
    """Likewise, about the centre of mass [N m]."""
    pulls: tuple[Pull, ...] = ()
    """Springs that pull a dynamic body; events may move them, and release it by setting none."""

    @model_validator(mode="after")
    def _weighs_one_way(self) -> Self:
        # A canonical dump names the default, too.
        if self.mass is not None and self.density != type(self).model_fields["density"].default:
            raise ValueError("mass and density exclude each other: remove one of them")
        return self

    @model_validator(mode="after")
    def _motion_is_consistent(self) -> Self:
        moves = any(self.velocity) or any(self.angular_velocity)
        if self.motion == "prescribed" and not (self.keyframes or moves):
            raise ValueError("motion prescribed needs keyframes, or velocity or angular_velocity: add one of them")
        if self.motion != "prescribed" and self.keyframes:
            raise ValueError("keyframes are for prescribed bodies: add `motion: prescribed`, or remove them")
        if self.motion == "static" and moves:
            raise ValueError("velocities are for bodies that move: add `motion: prescribed`, or remove them")
        if self.keyframes and moves:
            raise ValueError("keyframes exclude velocity and angular_velocity: give one of the two")
        if self.start is not None and (self.motion != "prescribed" or self.keyframes):
            raise ValueError("start is for prescribed bodies without keyframes: remove it")
        if self.keyframes and any(self.position) and self.position != self.keyframes[0].position:
            raise ValueError("position differs from that of the first keyframe: leave position out")
        if self.motion != "dynamic" and (any(self.force) or any(self.torque) or self.pulls):
            raise ValueError(
                "force, torque and pulls are for bodies that obey them: add `motion: dynamic`, or remove them"
            )
        if self.motion != "static" and self.shape.type in {"plane", "sheet"}:
            raise ValueError(f"motion of a {self.shape.type} can only be static: use a thin box")
        return self

    @model_validator(mode="after")
    def _keyframes_are_in_order(self) -> Self:
        for earlier, later in itertools.pairwise(self.keyframes):
            if later.at <= earlier.at:
                raise ValueError(
                    f"the keyframe at {later.at:g} s follows the one at {earlier.at:g} s: "
                    "sort keyframes by their time, no two at the same"
                )
            if self._turned(earlier, later) >= 180.0:
                raise ValueError(
                    f"half a turn or more from {earlier.at:g} s to {later.at:g} s, but bodies turn the shorter way: "
                    "give keyframes in between, or angular_velocity instead of keyframes"
                )
        return self

    def _turned(self, earlier: Keyframe, later: Keyframe) -> float:
        """The angle [deg] between two keyframes that turn about the same axis; 0 where the axes differ."""
        turns = [self.rotation if key.rotation is None else key.rotation for key in (earlier, later)]
        if max(map(len, turns)) > 1 or len({turn.axis for pair in turns for turn in pair}) > 1:
            return 0.0
        return abs(sum(turn.angle for turn in turns[1]) - sum(turn.angle for turn in turns[0]))


class ContactPair(Settings):
    """Friction and restitution between two bodies or containers, instead of those that follow from each."""

    between: tuple[Name, Name]
    """Names of two rigid bodies, or of one and a container."""
    friction: Friction | None = None
    static_friction: Friction | None = None
    restitution: Restitution | None = None


class Rigid(Settings):
    """The rigid bodies of the scene, and the solver for their contacts."""

    bodies: Annotated[dict[Name, RigidBody], Field(min_length=1)]
    pairs: tuple[ContactPair, ...] = ()
    """Exceptions from the friction and restitution of the bodies; the last match counts."""
    max_step: Annotated[PositiveDuration, Le(0.1)] = 0.004
    """Longest time step of a scene with dynamic bodies [s]."""
    contact_error: Annotated[Speed, Gt(0)] = 1e-8
    """Sweeps over the contacts end once none changes a relative velocity by more than this [m/s], or, where contacts
    contradict one another, by more than 1000 times this for each m/s that contacts change in the step."""
    max_iterations: Annotated[int, Ge(1), Le(100_000)] = 500
    """Maximum number of sweeps in a step; steps that would need more are counted and reported."""
