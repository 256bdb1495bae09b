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
    """Air that is drawn in where fluid meets fluid (Ihmsen et al. 2012, eq. 2 and 3)."""

    rate: Rate = 400.0
    """Particles of foam that a particle of the fluid makes at most [1/s]."""
    low: Speed = 2.0
    """Sum of the speeds at which neighbours approach, weighted by their nearness [m/s]."""
    high: Speed = 12.0


class WaveCrest(Range):
    """Foam that tears off the crests of waves (Ihmsen et al. 2012, eq. 4 to 8)."""

    rate: Rate = 400.0
    """Particles of foam that a particle of the fluid makes at most [1/s]."""
    low: Annotated[Dimensionless, Ge(0)] = 2.0
    """Sum of the bends of the surface towards neighbours, weighted by their nearness [1]."""
    high: Annotated[Dimensionless, Ge(0)] = 8.0


class Agitation(Range):
    """How fast the fluid has to be to make any foam, by its kinetic energy (Ihmsen et al. 2012, eq. 9)."""

    low: Speed = 0.8
    """[m/s]"""
    high: Speed = 3.0
    """[m/s]"""


class Lifetime(Range):
    """Of foam on the water; spray and bubbles do not age (Ihmsen et al. 2012, sec. 3.3). What is made where much is
    made lives long."""

    low: PositiveDuration = 1.0
    """[s]"""
    high: PositiveDuration = 4.0
    """[s]"""


class FoamSpec(Settings):
    """Foam, spray and bubbles. Their kind follows from how many particles of the fluid are near: few, some, many."""

    trapped_air: TrappedAir = TrappedAir()
    wave_crest: WaveCrest = WaveCrest()
    agitation: Agitation = Agitation()
    lifetime: Lifetime = Lifetime()
    spray_below: Annotated[int, Ge(0), Le(1000)] = 6
    """With fewer particles of the fluid within the support radius than this it is spray, which flies."""
    bubbles_above: Annotated[int, Ge(0), Le(1000)] = 20
    """With more than this it is a bubble, which rises; in between it is foam, which floats."""
    buoyancy: Annotated[Dimensionless, Ge(0), Le(100)] = 2.0
    """Upward acceleration of bubbles at rest in the fluid, over gravity (Ihmsen et al. 2012, eq. 12); 2 is that of a
    light ball, which has to move half its volume of the fluid along."""
    relaxation_time: PositiveDuration = 0.012
    """In which drag takes a bubble to within 1 / e of its speed of rising [s] (Ihmsen et al. 2012, eq. 12, whose drag
    coefficient depends on the step): 12 ms with a buoyancy of 2 are 0.24 m/s, as of bubbles of some millimetres in
    water."""
    radius: PositiveLength | None = None
    """Of a mean particle of foam in the picture [m], from half to one and a half of it; without it, a sixth of the
    fluid's particle radius."""
    max_step: PositiveDuration = 0.01
    """Between frames the fluid is interpolated at steps no longer than this [s]."""
    max_particles: Annotated[int, Gt(0), Le(100_000_000)] = 2_000_000
    """No more are made while there are so many; the job says so."""
    seed: Annotated[int, Ge(0), Le(2**31)] = 0
    """Of what is random about them: where within the fluid's particles they begin, how large they are."""

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
