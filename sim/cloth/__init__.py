"""Cloth: masses and springs, stepped by one of three integrators."""

from importlib import import_module
from typing import Any

MATERIALS = ("cloth",)
"""Of a scene, for this to be loaded."""

INTEGRATORS = {
    "symplectic_euler": "sim.cloth.integrators.symplectic_euler:SymplecticEuler",
    "implicit_euler": "sim.cloth.integrators.implicit_euler:ImplicitEuler",
    "xpbd": "sim.cloth.integrators.xpbd:XPBD",
}
"""By the name they have in a scene."""


def load_integrator(name: str) -> type[Any]:
    """The class of an integrator; only the chosen one is imported."""
    module, _, attribute = INTEGRATORS[name].partition(":")
    return getattr(import_module(module), attribute)
