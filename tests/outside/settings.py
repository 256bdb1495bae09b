"""Settings of what this package adds."""

from typing import ClassVar, Literal

from scene.settings import Settings
from scene.units import PositiveDuration, PositiveLength


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


class Neon(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.look:build"
    type: Literal["neon"]
    strength: float = 1.0
