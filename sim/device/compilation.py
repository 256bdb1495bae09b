"""How long kernels take to compile, or to be loaded from the cache.

Taichi does so in the first call of a kernel and does not tell, so calls are watched; the work that the first call does
is counted, too.
"""

from __future__ import annotations

import functools
import time
from typing import Any

_seconds = 0.0


def seconds() -> float:
    """Spent in this process so far."""
    return _seconds


@functools.cache
def watch() -> None:
    """Take the time of calls that compile, from now on."""
    from sim.device.compiler import compiled, ti

    Kernel = ti.lang.kernel_impl.Kernel
    call = Kernel.__call__

    @functools.wraps(call)
    def timed(kernel: Any, *args: object, **options: object) -> object:
        global _seconds
        known, start = len(compiled(kernel)), time.perf_counter()
        told = call(kernel, *args, **options)
        if len(compiled(kernel)) > known:
            _seconds += time.perf_counter() - start
        return told

    Kernel.__call__ = timed
