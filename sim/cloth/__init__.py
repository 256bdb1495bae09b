"""Cloth: masses and springs, stepped by one of several integrators.

Only `sim.coupling` and `sim.run` import it.
"""

from typing import Any

from common.registry import added, load

MATERIALS = ("cloth",)
"""Of a scene, for this to be loaded."""
INTEGRATORS = {
    "symplectic_euler": "sim.cloth.integrators.symplectic_euler:SymplecticEuler",
    "implicit_euler": "sim.cloth.integrators.implicit_euler:ImplicitEuler",
    "xpbd": "sim.cloth.integrators.xpbd:XPBD",
}
"""By the name they have in a scene, beside those of installed packages."""


OF_SHELLS = {
    **INTEGRATORS,
    "symplectic_euler": "sim.cloth.shell.euler:ShellEuler",
    "xpbd": "sim.cloth.shell.xpbd:ShellXPBD",
}
"""The same for shells."""


def load_integrator(name: str, model: str = "springs") -> type[Any]:
    """The class of an integrator; only the chosen one is imported."""
    known = OF_SHELLS if model == "fem" else INTEGRATORS
    return load(known[name] if name in known else added("integrators")[name].IMPLEMENTATION)
