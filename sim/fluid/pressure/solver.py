"""What a pressure solver says of itself, and what it is asked to do."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar

from sim.device.arrays import Declared

if TYPE_CHECKING:
    from sim.fluid.forces.momentum import Momentum
    from sim.fluid.measure import Measure
    from sim.fluid.spec import Fluid
    from sim.fluid.system import FluidSystem


class PressureSolver(ABC):
    """Advances a FluidSystem; `fastest_signal` is the numerical speed of sound [m/s], faster than which no particle is.

    Its attributes are all that the rest of a run knows of it: no one asks for its name.
    """

    ARRAYS: ClassVar[tuple[Declared, ...]] = ()
    """What it needs of particles, beside `sim.fluid.system.PARTICLES`."""
    SAMPLE_ARRAYS: ClassVar[tuple[Declared, ...]] = ()
    """What is kept besides where there are samples of sheets, for the force on them."""
    STATISTICS: ClassVar[tuple[str, ...]] = ()
    """What `advance` tells of a step: columns of steps.csv."""
    SKIN: ClassVar[float] = 0.0
    """By what share of the support radius further neighbours are listed, so that lists serve for several steps."""
    HOLDS_ALONG_ALL: ClassVar[bool] = False
    """Whether bodies that obey forces hold fluid along their surfaces as others do, and feel it
    (`Bodies.hold_along_surfaces`)."""
    WEAKLY_COMPRESSIBLE: ClassVar[bool] = False
    """Whether pressures follow from densities by an equation of state, so that sound limits steps, and speeds."""
    SPEED_OF_SOUND: ClassVar[str] = ""
    """Name of its setting of the numerical speed of sound [m/s] or `auto`, if it has one."""
    ERRORS: ClassVar[tuple[str, ...]] = ()
    """Names of its settings that say how large an error a step may leave; of the density first."""
    CAP: ClassVar[str] = ""
    """Name of its setting of the most iterations, after which a step goes on with a larger error, if it iterates."""

    system: FluidSystem
    momentum: Momentum

    @abstractmethod
    def __init__(self, system: FluidSystem, fastest_signal: float): ...

    @classmethod
    def speed_of_sound_given(cls, fluid: Fluid) -> float | None:
        """The numerical speed of sound [m/s] that the settings of a fluid ask for, if they do."""
        given = getattr(fluid.solver_settings, cls.SPEED_OF_SOUND) if cls.SPEED_OF_SOUND else "auto"
        return None if given == "auto" else float(given)

    @classmethod
    def remedies(cls, fluid: Fluid) -> list[str]:
        """What of its settings helps where particles were pushed too hard, as in `use a lower VISCOSITY`."""
        settings = fluid.solver_path
        sound = [f"a higher {settings}.{cls.SPEED_OF_SOUND}"] if cls.SPEED_OF_SOUND else []
        errors = [f"a lower {settings}.{name}" for name in cls.ERRORS[:1]]
        return sound + errors + ([f"a higher {settings}.{cls.CAP}"] if cls.CAP else [])

    @abstractmethod
    def step_limits(self, measure: Measure, cfl: float) -> dict[str, float]:
        """Largest stable time steps [s] by what limits them; `cfl` is the scene's CFL number."""

    def limiting_term(self, term: str, measure: Measure, emitted: float) -> tuple[str, str]:
        """What one of `step_limits` comes from, and what would help; emitted: speed of the fastest emitter [m/s]."""
        match term:
            case "signal":
                signals = ", ".join(self.signals(measure, emitted))
                return f"the fastest signal ({signals})", "use lower speeds, less gravity, or larger particles"
            case "force":
                return f"the force on the particles ({measure.a_max:.3g} m/s^2)", "use weaker forces"
            case "pressure":
                remedy = "use water that is less deep, or larger particles"
                return f"the pressure in the fluid ({measure.pressure_max:.3g} Pa)", remedy
        return self.momentum.limiting_term(term)

    def signals(self, measure: Measure, emitted: float) -> list[str]:
        """What is fast in the fluid and around it, with its speed."""
        found = [f"fluid {measure.v_max:.3g} m/s"]
        found += [f"emitters {emitted:.3g} m/s"] if emitted else []
        return found + ([f"bodies {self.system.boundary.speed:.3g} m/s"] if self.system.boundary.moves else [])

    @abstractmethod
    def start(self) -> None:
        """Find densities and forces of the initial state, or of one that an event has changed."""

    @abstractmethod
    def restore(self) -> None:
        """Go on from a checkpoint: bring about exactly what a step would have left."""

    @abstractmethod
    def advance(self, dt: float) -> dict[str, float]:
        """Step by dt [s]; returns the STATISTICS, and what ended at a cap."""
