"""Forces in files of their own, each a pass after the others; only those that a scene asks for are imported."""

from __future__ import annotations

from typing import Protocol

from sim.device.arrays import Declared
from sim.fluid.spec import Fluid
from sim.fluid.system import FluidSystem


class Force(Protocol):
    """Adds to the accelerations of all particles; positions, velocities, densities and neighbours are given."""

    def accelerate(self) -> None: ...


def has_tension(fluid: Fluid) -> bool:
    return fluid.surface_tension > 0 and fluid.surface_tension_model == "akinci2013"


def force_arrays(fluid: Fluid) -> tuple[Declared, ...]:
    """The arrays of particles that these forces need."""
    if not has_tension(fluid):
        return ()
    from sim.fluid.forces import surface_tension

    return surface_tension.ARRAYS


def load_forces(system: FluidSystem) -> list[Force]:
    """The forces that the settings of a system ask for."""
    forces: list[Force] = []
    if has_tension(system.spec):
        from sim.fluid.forces.surface_tension import SurfaceTension

        forces.append(SurfaceTension(system))
    if system.spec.adhesion > 0 and (system.boundary.sampled > 0 or system.boundary.shapes.count > 0):
        from sim.fluid.forces.adhesion import Adhesion

        forces.append(Adhesion(system))
    return forces
