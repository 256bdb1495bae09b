"""Fluids by smoothed particle hydrodynamics."""

from importlib import import_module
from typing import Any

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""

SOLVERS = {
    "wcsph": "sim.fluid.pressure.wcsph:Wcsph",
    "pcisph": "sim.fluid.pressure.pcisph:Pcisph",
    "iisph": "sim.fluid.pressure.iisph:Iisph",
    "dfsph": "sim.fluid.pressure.dfsph:Dfsph",
}
"""Pressure solvers by the name they have in a scene."""


def load_solver(name: str) -> type[Any]:
    """The class of a pressure solver; only the chosen one is imported."""
    module, _, attribute = SOLVERS[name].partition(":")
    return getattr(import_module(module), attribute)
