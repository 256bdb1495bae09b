"""Start and stop of Taichi."""

from __future__ import annotations

import contextlib
import io
import os


def start(*, threads: int | None = None, arch: str = "auto") -> str:
    """Start Taichi, or start it anew with nothing allocated; returns the name of the architecture.

    `arch` is auto, cpu or cuda. Asking Taichi for "any GPU" crashes on machines with a display
    library and no GPU, so CUDA is asked for by name.
    """
    with contextlib.redirect_stdout(io.StringIO()):
        import taichi as ti
        from taichi.lang.misc import is_arch_supported

        ti.set_logging_level(ti.ERROR)
        if arch == "cuda" and not is_arch_supported(ti.cuda):
            from sim.settings import Refused

            raise Refused("no CUDA device was found", remedy="use --arch cpu, or leave --arch out")
        use_cuda = arch != "cpu" and is_arch_supported(ti.cuda)
        ti.init(
            arch=ti.cuda if use_cuda else ti.cpu,
            cpu_max_num_threads=threads or os.cpu_count() or 1,
            default_fp=ti.f32,
            default_ip=ti.i32,
            fast_math=True,
            offline_cache=True,
            offline_cache_cleaning_policy="lru",
            log_level=ti.ERROR,
        )
    return "cuda" if use_cuda else "cpu"
