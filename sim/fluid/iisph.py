"""Implicit incompressible SPH (Ihmsen et al. 2014): pressures that keep densities at rest density after the step."""

from typing import ClassVar

from sim.arrays import Declared
from sim.fluid import projection
from sim.fluid.conjugate_gradients import ConjugateGradients
from sim.fluid.incompressible import Incompressible, kick
from sim.fluid.projection import Projection
from sim.fluid.solids import remember_way
from sim.fluid.system import FluidSystem


class Iisph(Incompressible):
    """Advances a FluidSystem."""

    ARRAYS: ClassVar[tuple[Declared, ...]] = (
        *projection.ARRAYS,
        Declared("pressed", "vec4", "way by pressure in the last step [m]; w: q that acted after it", saved=False),
    )

    def __init__(self, system: FluidSystem, fastest_signal: float):
        super().__init__(system, fastest_signal)
        self.projection = Projection(system)
        self.gradients = ConjugateGradients(system)

    def examine(self, dt: float) -> None:
        self.projection.prepare(dt)

    def press(self, dt: float) -> dict[str, float]:
        system, settings = self.system, self.settings
        self.projection.predict(dt)
        tolerance = settings.density_error * system.spec.rest_density
        solution = self.gradients.solve(dt, tolerance, settings.min_iterations, settings.max_iterations, warm=True)
        kick(system.count, dt, system.particles.velocity, system.particles.kept)
        if system.boundary.count:
            remember_way(system.count, dt, system.particles.kept, system.particles.pressed)
        return {"pressure_iterations": solution.iterations, "capped": solution.capped}
