"""Settings of the fluid: one liquid, in one or more bodies."""

from __future__ import annotations

from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le

from sim.geometry.spec import ClosedShape, Placement
from sim.settings import Name, Settings
from sim.units import (
    Density,
    Dimensionless,
    KinematicViscosity,
    PositiveLength,
    PositiveSpeed,
    SurfaceTension,
    Velocity,
)


class FluidBody(Placement):
    """A volume filled with fluid at the start, or when an event adds it."""

    shape: ClosedShape
    velocity: Velocity = (0.0, 0.0, 0.0)
    """Initial velocity of every particle [m/s]."""


class Wcsph(Settings):
    """Settings of the weakly compressible solver (Becker & Teschner 2007)."""

    speed_of_sound: Literal["auto"] | PositiveSpeed = "auto"
    """Numerical speed of sound [m/s]. `auto` takes ten times the greatest speed that the scene's
    drop height and initial velocities allow, for about 1 % compression."""
    artificial_viscosity: Annotated[Dimensionless, Ge(0), Le(1)] = 0.05
    """Coefficient alpha of Monaghan (1992); damps the sound waves that compressibility brings."""
    wall_damping: Annotated[Dimensionless, Ge(0), Le(2)] = 1.0
    """The same coefficient for what runs into a solid: 0 makes drops bounce off, 1 makes them stay."""


class Incompressible(Settings):
    """Settings of a solver that looks for the pressures under which the fluid keeps its volume."""

    density_error: Annotated[Dimensionless, Gt(0), Le(0.1)] = 0.0005
    """Mean compression that a step may leave, as a share of the rest density: 0.0005 is 0.05 %."""
    min_iterations: Annotated[int, Ge(1), Le(1000)] = 2
    max_iterations: Annotated[int, Ge(1), Le(100_000)] = 100
    """Iterations after which a step goes on with a larger error; such steps are counted in summary.json."""


class Dfsph(Incompressible):
    """Settings of divergence-free SPH (Bender & Koschier 2017)."""

    divergence_error: Annotated[Dimensionless, Gt(0), Le(0.1)] = 0.001
    """Mean compression in one step by the velocities after it, as a share of the rest density."""


class Fluid(Settings):
    """The liquid and how it is simulated."""

    particle_radius: Annotated[PositiveLength, Le(10.0)]
    """Half the spacing of the particles [m]: halving it costs about 16 times the time."""
    bodies: dict[Name, FluidBody] = {}
    """The volumes that hold fluid at the start, by name; events may add more."""
    solver: Literal["wcsph", "pcisph", "iisph", "dfsph"] = "wcsph"
    support_ratio: Annotated[Dimensionless, Ge(3), Le(6)] = 4.0
    """Support radius of the kernel over the particle radius."""
    rest_density: Density = 1000.0
    viscosity: KinematicViscosity = 1e-6
    """Kinematic viscosity [m^2/s]: water 1e-6, honey about 7e-3."""
    surface_tension: SurfaceTension = 0.0
    """Coefficient of surface tension [N/m]: water in air 0.072."""
    max_particles: Annotated[int, Gt(0), Le(50_000_000)] = 5_000_000
    """More fluid particles than this are refused before the simulation starts."""
    wcsph: Wcsph = Wcsph()
    pcisph: Incompressible = Incompressible()
    iisph: Incompressible = Incompressible()
    dfsph: Dfsph = Dfsph()

    @property
    def spacing(self) -> float:
        """Distance of neighbouring particles in the initial lattice [m]."""
        return 2.0 * self.particle_radius

    @property
    def support_radius(self) -> float:
        """Radius at which the kernel reaches zero [m]."""
        return self.support_ratio * self.particle_radius
