"""Forces in files of their own, each a pass after the others; only those that act in a scene are imported."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from common.registry import added, load
from sim.device.arrays import Declared
from sim.fluid.forces.force import Force
from sim.fluid.spec import Fluid
from sim.fluid.system import FluidSystem


@dataclass(frozen=True)
class Registered:
    where: str
    """`module:class`."""
    acts: Callable[[Fluid], bool]
    """Whether the settings ask for it."""


FORCES = (
    Registered(
        "sim.fluid.forces.surface_tension:SurfaceTension",
        lambda fluid: fluid.surface_tension > 0 and fluid.surface_tension_model == "akinci2013",
    ),
    Registered("sim.fluid.forces.adhesion:Adhesion", lambda fluid: fluid.adhesion > 0),
)
"""In the order in which they are added."""


def acting(fluid: Fluid) -> Iterator[type[Force]]:
    """The forces that the settings ask for; those of installed packages where `fluid.extra` has their settings."""
    for force in FORCES:
        if force.acts(fluid):
            yield load(force.where)
    for name, settings in added("forces").items():
        if name in fluid.extra:
            yield load(settings.IMPLEMENTATION)


def force_arrays(fluid: Fluid) -> tuple[Declared, ...]:
    """The arrays of particles that these forces need."""
    return tuple(array for force in acting(fluid) for array in force.ARRAYS)


def load_forces(system: FluidSystem) -> list[Force]:
    """The forces of a system."""
    return [force(system) for force in acting(system.spec) if force.applies(system)]
