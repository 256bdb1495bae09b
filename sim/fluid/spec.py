"""Settings of the fluid: one liquid, in one or more bodies."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from common.registry import added, names
from scene.extra import Added, of_packages
from scene.settings import Name, Settings
from scene.units import (
    AngularVelocity,
    Density,
    Dimensionless,
    Duration,
    KinematicViscosity,
    PositiveDuration,
    PositiveLength,
    PositiveSpeed,
    SurfaceTension,
    Velocity,
    VelocityGradient,
    VolumeRate,
)
from sim.fluid import SOLVERS
from sim.geometry.spec import ClosedShape, MeshFace, Placement

DIVERGENCE_TOLERANCE = 1e-6
"""Share of the greatest number of a velocity gradient by which its diagonal may miss zero: numbers are typed."""


class FluidBody(Placement):
    """A volume filled with fluid at the start, or when an event adds it."""

    shape: ClosedShape
    packing: Literal["auto", "lattice", "relaxed"] = "auto"
    """Initial arrangement of particles: the cubic `lattice`, which is at rest in a tank, or `relaxed`, without order
    as in a fluid that has flowed, which keeps its volume in whatever direction it is stretched. `auto` uses the
    lattice for boxes and cylinders."""
    velocity: Velocity = (0.0, 0.0, 0.0)
    """Initial velocity at `position` [m/s], and of every particle unless another setting adds to it."""
    angular_velocity: AngularVelocity = (0.0, 0.0, 0.0)
    """Initial angular velocity about `position` [rad/s]: adds omega x (x - position) to the velocity."""
    velocity_gradient: VelocityGradient = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    """Initial velocity gradient G [1/s], three rows: adds G (x - position) to the velocity, in world axes. Its trace
    is zero, since the fluid is incompressible."""

    @model_validator(mode="after")
    def _keeps_volume(self) -> Self:
        rows = self.velocity_gradient
        divergence = sum(rows[axis][axis] for axis in range(3))
        if abs(divergence) > DIVERGENCE_TOLERANCE * max(abs(value) for row in rows for value in row):
            raise ValueError(
                f"velocity_gradient must not compress the fluid: its diagonal adds up to {divergence:.4g} /s, not 0: "
                "lower one of its three values"
            )
        return self


class Disc(Settings):
    """A round outlet around its centre, its direction along y."""

    type: Literal["disc"]
    radius: PositiveLength


class Rectangle(Settings):
    """A rectangular outlet around its centre, its direction along y."""

    type: Literal["rectangle"]
    size: tuple[PositiveLength, PositiveLength]
    """Edge lengths along x and z [m]."""


class Timed(Placement):
    """What works for a part of the time."""

    start: Duration = 0.0
    """Start time [s]."""
    stop: PositiveDuration | None = None
    """End time [s]; never by default."""

    @model_validator(mode="after")
    def _starts_before_it_stops(self) -> Self:
        if self.stop is not None and self.stop <= self.start:
            raise ValueError(
                f"stop ({self.stop:g} s) must be later than start ({self.start:g} s): raise stop, or leave it out"
            )
        return self


class Emitter(Timed):
    """An outlet that emits fluid along the shape's own, rotated y axis.

    Exactly one of speed and rate is given. The fluid moves straight on at this speed for one support radius, as in a
    nozzle of that length, and is then free.
    """

    shape: Annotated[Disc | Rectangle | MeshFace, Field(discriminator="type")]
    speed: PositiveSpeed | None = None
    """Speed of the fluid [m/s]."""
    rate: VolumeRate | None = None
    """Volume emitted per second [m^3/s]; the speed follows from it and the area that the particles cover."""

    @model_validator(mode="after")
    def _speed_or_rate(self) -> Self:
        if (self.speed is None) == (self.rate is None):
            remedy = "add one of them" if self.speed is None else "remove one of them"
            raise ValueError(f"an emitter needs exactly one of speed and rate: {remedy}")
        return self


class Drain(Timed):
    """A volume in which fluid vanishes."""

    shape: ClosedShape


class Wcsph(Settings):
    """Settings of the weakly compressible solver (Becker & Teschner 2007)."""

    speed_of_sound: Literal["auto"] | PositiveSpeed = "auto"
    """Numerical speed of sound [m/s]. `auto` uses ten times the greatest speed that the scene's drop height and
    initial velocities allow, for about 1 % compression."""
    artificial_viscosity: Annotated[Dimensionless, Ge(0), Le(1)] = 0.05
    """Coefficient alpha of Monaghan 1992; damps the sound waves that compressibility causes."""
    wall_damping: Annotated[Dimensionless, Ge(0), Le(2)] = 1.0
    """The same coefficient for fluid that runs into a solid: with 0 drops bounce off, with 1 they stay."""


class Incompressible(Settings):
    """Settings of a solver for the pressures under which the fluid keeps its volume."""

    density_error: Annotated[Dimensionless, Gt(0), Le(0.1)] = 0.0001
    """Mean compression that a step may leave, as a share of the rest density: 0.0001 is 0.01 %, at which water comes
    to rest; 0.0005 is faster and sufficient for a splash."""
    min_iterations: Annotated[int, Ge(1), Le(1000)] = 2
    max_iterations: Annotated[int, Ge(1), Le(100_000)] = 100
    """Iterations after which a step continues with a larger error; such steps are counted in summary.json. In fluid
    deeper than 25 layers of particles, the cap rises in proportion to the depth."""

    @model_validator(mode="after")
    def _least_below_most(self) -> Self:
        if "min_iterations" in self.model_fields_set and self.min_iterations > self.max_iterations:
            raise ValueError(
                f"min_iterations ({self.min_iterations}) must be at most max_iterations ({self.max_iterations}): "
                "lower the one, or raise the other"
            )
        return self


class Pcisph(Incompressible):
    """Settings of predictive-corrective SPH (Solenthaler & Pajarola 2009)."""

    density_error: Annotated[Dimensionless, Gt(0), Le(0.1)] = 0.0005
    """Mean compression that a step may leave, as a share of the rest density; iterations grow fast below this one."""


class Dfsph(Incompressible):
    """Settings of divergence-free SPH (Bender & Koschier 2017): a step solves for divergence-free velocities, and
    for densities no higher than at rest."""

    iteration: Literal["conjugate_gradients", "jacobi"] = "conjugate_gradients"
    """How pressures are found. By default both solves use projected conjugate gradients: the one for velocities has
    gradients that are right for any arrangement of particles, the one for densities moves particles apart without
    giving them velocities. `jacobi` is DFSPH as published: Jacobi iterations with the factor alpha, uncorrected
    gradients, and both solves changing velocities. It is there for comparison, and not for scenes with cloth or
    dynamic bodies."""
    divergence_error: Annotated[Dimensionless, Gt(0), Le(0.1)] = 0.0001
    """Mean compression in one step by the velocities after it, as a share of the rest density; conjugate gradients
    use a tenth of it where there are bodies; in fluid N > 25 layers deep it is divided by N / 25."""
    hyperviscosity: Annotated[Dimensionless, Ge(0), Le(100)] = 3.0
    """For conjugate gradients: decay rate of velocity differences between neighbours that do not belong to a smooth
    flow, over sqrt(g / spacing). With 0, particles at rest jitter; more than the default slows features of only a
    few spacings."""


class ImplicitViscosity(Settings):
    """Settings of implicit viscosity (Weiler et al. 2018)."""

    error: Annotated[Dimensionless, Gt(0), Le(0.1)] = 0.001
    """Relative error that a step may leave in the change of velocities by viscosity."""
    max_iterations: Annotated[int, Ge(1), Le(100_000)] = 200
    """Iterations after which a step continues with a larger error; such steps are counted in summary.json."""


class Fluid(Settings):
    """The liquid and how it is simulated."""

    particle_radius: Annotated[PositiveLength, Le(10.0)]
    """Half the spacing of the particles [m]: halving it costs about 16 times the time."""
    bodies: dict[Name, FluidBody] = {}
    """Volumes filled with fluid at the start, by name; events may add more."""
    emitters: dict[Name, Emitter] = {}
    """Outlets that emit fluid, by name."""
    drains: dict[Name, Drain] = {}
    """Volumes in which fluid vanishes, by name."""
    solver: Literal[(*SOLVERS, *names("solvers", *SOLVERS))] = "wcsph"
    support_ratio: Annotated[Dimensionless, Ge(3), Le(6)] = 4.0
    """Support radius of the kernel over the particle radius."""
    rest_density: Density = 1000.0
    viscosity: KinematicViscosity = 1e-6
    """Kinematic viscosity [m^2/s]: water 1e-6, honey about 7e-3."""
    wall_slip: Literal["no_slip", "free_slip"] = "no_slip"
    """Whether solids slow the fluid along their surface: with `no_slip` it sticks to them, in proportion to
    `viscosity`."""
    viscosity_solver: Literal["auto", "explicit", "implicit"] = "auto"
    """How viscosity is integrated: `explicit`, which limits the step; `implicit`, a linear system in each step; or
    `auto`, implicit where explicit viscosity would limit the step more than anything else."""
    implicit_viscosity: ImplicitViscosity = ImplicitViscosity()
    xsph: Annotated[Dimensionless, Ge(0), Le(1)] = 0.0
    """Share of its neighbours' mean velocity that each particle takes on in every step (Monaghan 1989): smooths
    disorder, and slows the flow."""
    surface_tension: SurfaceTension = 0.0
    """Coefficient of surface tension [N/m]: water in air 0.072."""
    surface_tension_model: Literal["becker2007", "akinci2013"] = "becker2007"
    """Attraction between neighbours (Becker & Teschner 2007), or cohesion that repels at close range and a force
    that minimises the surface (Akinci et al. 2013a)."""
    adhesion: SurfaceTension = 0.0
    """Work per area that separates the fluid from solids [N/m]: surface_tension times 1 + cos of the contact angle."""
    max_particles: Annotated[int, Gt(0), Le(50_000_000)] = 5_000_000
    """More fluid particles than this are refused before the simulation starts; emitters pause while there are
    so many."""
    wcsph: Wcsph = Wcsph()
    pcisph: Pcisph = Pcisph()
    iisph: Incompressible = Incompressible()
    dfsph: Dfsph = Dfsph()
    extra: Annotated[dict[Name, Added], of_packages("forces", "solvers")] = {}
    """Settings of forces and solvers that installed packages add, by their names; a force acts where it is named."""

    @property
    def solver_settings(self) -> Any:
        """Those of the chosen solver."""
        if self.solver in type(self).model_fields:
            return getattr(self, self.solver)
        return self.extra.get(self.solver) or added("solvers")[self.solver]()

    @property
    def solver_path(self) -> str:
        """Where they are in a scene: names with dots between them."""
        return f"fluid.{self.solver}" if self.solver in type(self).model_fields else f"fluid.extra.{self.solver}"

    @property
    def method(self) -> str:
        """Name of what finds the pressures, in `sim.fluid.SOLVERS` or VARIANTS, or that of an installed package."""
        return "dfsph_jacobi" if self.solver == "dfsph" and self.dfsph.iteration == "jacobi" else self.solver

    @property
    def spacing(self) -> float:
        """Distance of neighbouring particles in the initial lattice [m]."""
        return 2.0 * self.particle_radius

    @property
    def support_radius(self) -> float:
        """Radius at which the kernel reaches zero [m]."""
        return self.support_ratio * self.particle_radius
