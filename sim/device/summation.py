"""In which order kernels add.

Taichi's fast_math lets LLVM add in any order, and it takes sums over a few neighbours four at a time then, by
gathers: kernels that follow springs, contacts or trees took three to seven times as long. Those named here add as
written.
"""

from __future__ import annotations

import functools
from typing import Any

AS_WRITTEN = ("sim.cloth.",)
"""Beginnings of the names of modules. Sums of fluids are long: most of their kernels are faster in any order."""


@functools.cache
def keep_order() -> None:
    """Compile kernels of these modules without fast_math, from now on."""
    from sim.device.compiler import ti

    Kernel = ti.lang.kernel_impl.Kernel
    call = Kernel.__call__

    @functools.wraps(call)
    def called(kernel: Any, *args: object, **options: object) -> object:
        if not kernel.func.__module__.startswith(AS_WRITTEN):
            return call(kernel, *args, **options)
        config = ti.lang.impl.current_cfg()
        chosen, config.fast_math = config.fast_math, False
        try:
            return call(kernel, *args, **options)
        finally:
            config.fast_math = chosen

    Kernel.__call__ = called
