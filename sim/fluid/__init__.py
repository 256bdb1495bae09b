"""Fluids by smoothed particle hydrodynamics."""

from importlib import import_module

SOLVERS = {
    "wcsph": "sim.fluid.wcsph:Wcsph",
    "pcisph": "sim.fluid.pcisph:Pcisph",
    "iisph": "sim.fluid.iisph:Iisph",
    "dfsph": "sim.fluid.dfsph:Dfsph",
}
"""Pressure solvers by the name they have in a scene."""


def load_solver(name: str) -> type:
    """The class of a pressure solver; only the chosen one is imported."""
    module, _, attribute = SOLVERS[name].partition(":")
    return getattr(import_module(module), attribute)
