"""Typed settings of foam: the scene file's `foam:` section, and what a job of its stage takes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Self

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from scene.settings import Settings
from scene.units import Acceleration, Dimensionless, PositiveDuration, PositiveLength, Unit
from sim.bodies.wall import Wall

Rate = Annotated[float, Ge(0), Le(1e7), Unit("1/s")]
Speed = Annotated[float, Ge(0), Le(1e5), Unit("m/s")]


class Range(Settings):
    """Below `low` nothing, from `high` on everything, in between in proportion (Ihmsen et al. 2012, eq. 1)."""

    if TYPE_CHECKING:  # each kind has bounds of its own
        low: float
        high: float

    @model_validator(mode="after")
    def _grows(self) -> Self:
        if self.low >= self.high:
            raise ValueError("low must be below high: swap them")
        return self


class TrappedAir(Range):
    """Air entrained where fluid meets fluid (Ihmsen et al. 2012, eq. 2 and 3)."""

    rate: Rate = 400.0
    """Maximum number of foam particles that one fluid particle makes [1/s]."""
    low: Speed = 2.0
    """Sum of the speeds at which neighbours approach, weighted by proximity [m/s]."""
    high: Speed = 12.0


class WaveCrest(Range):
    """Foam that breaks off wave crests (Ihmsen et al. 2012, eq. 4 to 8)."""

    rate: Rate = 400.0
    """Maximum number of foam particles that one fluid particle makes [1/s]."""
    low: Annotated[Dimensionless, Ge(0)] = 2.0
    """Curvature of the surface, summed over neighbours and weighted by proximity [1]."""
    high: Annotated[Dimensionless, Ge(0)] = 8.0


class Agitation(Range):
    """Speed that the fluid needs to make any foam, by its kinetic energy (Ihmsen et al. 2012, eq. 9)."""

    low: Speed = 0.8
    """[m/s]"""
    high: Speed = 3.0
    """[m/s]"""


class Lifetime(Range):
    """Lifetime of foam on the water; spray and bubbles do not age (Ihmsen et al. 2012, sec. 3.3). Foam lives longer
    where more of it is made."""

    low: PositiveDuration = 1.0
    """[s]"""
    high: PositiveDuration = 4.0
    """[s]"""


class FoamSpec(Settings):
    """Foam, spray and bubbles. Their kind depends on the number of fluid particles nearby: few, some, many."""

    trapped_air: TrappedAir = TrappedAir()
    wave_crest: WaveCrest = WaveCrest()
    agitation: Agitation = Agitation()
    lifetime: Lifetime = Lifetime()
    spray_below: Annotated[int, Ge(0), Le(1000)] = 6
    """With fewer fluid particles than this within the support radius it is spray, which flies."""
    bubbles_above: Annotated[int, Ge(0), Le(1000)] = 20
    """With more than this it is a bubble, which rises; in between it is foam, which floats."""
    buoyancy: Annotated[Dimensionless, Ge(0), Le(100)] = 2.0
    """Upward acceleration of bubbles at rest in the fluid, over gravity (Ihmsen et al. 2012, eq. 12); 2 is that of a
    light ball, whose added mass is half its volume of fluid."""
    relaxation_time: PositiveDuration = 0.012
    """Time in which drag brings a bubble to within 1 / e of its rising speed [s] (Ihmsen et al. 2012, eq. 12, whose
    drag coefficient depends on the step): 12 ms with a buoyancy of 2 give 0.24 m/s, as for bubbles of a few
    millimetres in water."""
    radius: PositiveLength | None = None
    """Mean radius of a foam particle in the picture [m]; radii vary from half to one and a half of it. By default a
    sixth of the fluid's particle radius."""
    max_step: PositiveDuration = 0.01
    """Between frames the fluid is interpolated at steps no longer than this [s]."""
    max_particles: Annotated[int, Gt(0), Le(100_000_000)] = 2_000_000
    """While there are this many, no more are made; the job reports it."""
    seed: Annotated[int, Ge(0), Le(2**31)] = 0
    """Random seed of their initial positions within the fluid's particles, and of their sizes."""

    @model_validator(mode="after")
    def _kinds_in_order(self) -> Self:
        if self.spray_below > self.bubbles_above + 1:
            raise ValueError("spray_below must be at most bubbles_above + 1, as no count can be both: lower it")
        return self


class FoamJobSpec(Settings):
    """What `python -m workflow.foam --spec` takes."""

    foam: FoamSpec = FoamSpec()
    particle_radius: PositiveLength
    """Of the fluid: half the spacing of its particles [m]."""
    support_radius: PositiveLength
    """Of the fluid's kernel [m]."""
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, -9.81, 0.0)
    fps: Annotated[float, Gt(0), Le(1e6), Unit("Hz")]
    """Frames per simulated second."""
    walls: Annotated[tuple[Wall, ...], Field(default_factory=tuple)]
    """Planes that hold spray and foam."""
