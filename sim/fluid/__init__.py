"""Fluids by smoothed particle hydrodynamics.

Only `sim.coupling`, `sim.run` and `sim.foam` import it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from common.registry import added, load

if TYPE_CHECKING:
    from sim.fluid.pressure.solver import PressureSolver

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""
SOLVERS = {
    "wcsph": "sim.fluid.pressure.wcsph:Wcsph",
    "pcisph": "sim.fluid.pressure.pcisph:Pcisph",
    "iisph": "sim.fluid.pressure.iisph:Iisph",
    "dfsph": "sim.fluid.pressure.dfsph:Dfsph",
}
"""Pressure solvers by the name they have in a scene, beside those of installed packages."""
VARIANTS = {"dfsph_jacobi": "sim.fluid.pressure.dfsph_jacobi:DfsphJacobi"}
"""What else the settings of a solver may choose, by the name that `Fluid.method` has for it."""


def load_solver(name: str) -> type[PressureSolver]:
    """The class of a pressure solver, by `Fluid.method`; only the chosen one is imported."""
    own = SOLVERS | VARIANTS
    return load(own[name] if name in own else added("solvers")[name].IMPLEMENTATION)
