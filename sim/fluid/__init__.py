"""Fluids by smoothed particle hydrodynamics.

Only `sim.coupling`, `sim.run` and `sim.foam` import it.
"""

from typing import Any

from common.registry import added, load

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""
SOLVERS = {
    "wcsph": "sim.fluid.pressure.wcsph:Wcsph",
    "pcisph": "sim.fluid.pressure.pcisph:Pcisph",
    "iisph": "sim.fluid.pressure.iisph:Iisph",
    "dfsph": "sim.fluid.pressure.dfsph:Dfsph",
}
"""Pressure solvers by the name they have in a scene, beside those of installed packages."""


def load_solver(name: str) -> type[Any]:
    """The class of a pressure solver; only the chosen one is imported."""
    return load(SOLVERS[name] if name in SOLVERS else added("solvers")[name].IMPLEMENTATION)
