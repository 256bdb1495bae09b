"""Settings of what this package adds."""

from typing import ClassVar, Literal

from scene.settings import Name, Settings
from scene.units import Position, PositiveDuration, PositiveLength
from sim.run.probes.probe import ProbeSettings
from workflow.formats.format import FormatSettings


class Wind(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.force:Wind"
    acceleration: tuple[float, float, float]


class Mine(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.solver:Mine"
    density_error: float = 1e-3
    min_iterations: int = 2
    max_iterations: int = 100


class Same(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.integrator:Same"
    share: float = 0.69


class Verlet(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.integrator:Verlet"
    substeps: int = 1
    longest: PositiveDuration = 1.0


class Cone(Settings):
    """A cone on its base, its axis along y."""

    IMPLEMENTATION: ClassVar[str] = "outside.shape:triangles"
    type: Literal["cone"]
    radius: PositiveLength
    height: PositiveLength


class AngularMomentum(ProbeSettings):
    IMPLEMENTATION: ClassVar[str] = "outside.probe:angular_momentum"
    MATERIAL: ClassVar[str | None] = "fluid"
    type: Literal["angular_momentum"]
    about: Position = (0.0, 0.0, 0.0)


class Highest(ProbeSettings):
    IMPLEMENTATION: ClassVar[str] = "outside.probe:highest"
    MATERIAL: ClassVar[str | None] = "cloth"
    type: Literal["highest"]
    sheet: Name


class Neon(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.look:build"
    type: Literal["neon"]
    strength: float = 1.0


class ParticleTable(FormatSettings):
    IMPLEMENTATION: ClassVar[str] = "outside.format:write"
    columns: tuple[Literal["x", "y", "z", "vx", "vy", "vz", "density", "id"], ...] = ("x", "y", "z", "id")
