"""The compiler of kernels: all code has it from here, as `from sim.device.compiler import ti`.

Raises Refused at import where the compiler that was chosen is not installed.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from scene.settings import Refused
from sim.device.compiler_choice import VARIABLE, chosen
from sim.device.tracing import memoize

compiler = chosen()

if TYPE_CHECKING:
    import taichi as ti
else:
    try:
        ti = importlib.import_module(compiler.module)
    except ModuleNotFoundError as error:
        if error.name != compiler.module:
            raise
        raise Refused(
            f"the compiler {compiler.package} is not installed",
            remedy=f"install it beside Tidemill, or leave {VARIABLE} out",
        ) from None

if compiler.memoize:
    memoize(ti)


def compiled(kernel: Any) -> dict:
    """What a kernel has been compiled to so far, by the kinds of its arguments."""
    return getattr(kernel, compiler.compiled)
