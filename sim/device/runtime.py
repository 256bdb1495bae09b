"""Start of Taichi, once a process."""

from __future__ import annotations

import contextlib
import gc
import io
import os
import sys

from common.registry import packages
from sim.device import compilation, host_copies, kernel_cache, launching, serial_loops, summation
from sim.device.affinity import bound

_running: tuple[str, int, bool] | None = None


def start(*, threads: int | None = None, arch: str = "auto", serial: bool = False) -> str:
    """Start Taichi; returns the name of the architecture.

    `arch` is auto, cpu or cuda; raises Refused for cuda without a device, and where no kernels can be kept. `serial`:
    on a CPU, let all loops run in the thread that launches them, whatever `threads` says (`sim.device.serial_loops`);
    numbers are rounded in another way then.

    Asking Taichi for "any GPU" crashes on machines with a display library and no GPU, so CUDA is asked for by name.
    Arrays are freed one by one, so what runs already is kept: starting anew would compile all kernels again. Taichi's
    optimization of the control flow graph is left to LLVM: it took up to three quarters of the time to compile, and
    made no kernel faster.
    """
    global _running
    from sim.device import argument_packs
    from sim.device.compiler import compiler, ti

    is_arch_supported = ti.lang.misc.is_arch_supported
    with contextlib.redirect_stdout(io.StringIO()):
        ti.set_logging_level(ti.ERROR)
        if arch == "cuda" and not is_arch_supported(ti.cuda):
            from scene.settings import Refused

            raise Refused("no CUDA device was found", remedy="use --arch cpu, or leave --arch out")
        from sim.device import precision

        device = "cuda" if arch != "cpu" and is_arch_supported(ti.cuda) else "cpu"
        in_thread = serial and device == "cpu" and compiler.serial
        wanted = device, 1 if in_thread else threads or os.cpu_count() or 1, in_thread
        if wanted != _running:
            if _running:
                _disown()
            with bound(wanted[1]):
                ti.init(
                    arch=ti.cuda if device == "cuda" else ti.cpu,
                    cpu_max_num_threads=wanted[1],
                    default_fp=ti.f64 if precision.chosen == "double" else ti.f32,
                    default_ip=ti.i32,
                    fast_math=True,
                    cfg_optimization=False,
                    offline_cache=True,
                    offline_cache_file_path=kernel_cache.folder(),
                    offline_cache_cleaning_policy="lru",
                    log_level=ti.ERROR,
                    **compiler.options,
                )
            argument_packs.amend()
            compilation.watch()
            launching.forget()
            if compiler.serial:
                serial_loops.choose(serial=in_thread)
            if device == "cpu":
                summation.keep_order()
                if compiler.relaunch:
                    launching.install()
                    host_copies.install()
            _running = wanted
    return device


def _disown() -> None:
    """Let no array that is still held free anything once Taichi starts anew, which frees all of them.

    Taichi frees arrays by address, and what lies at that address by then may be another's.
    """
    from sim.device.compiler import compiler, ti

    pack = () if compiler.packs == "dataclass" else ti.lang.argpack.ArgPack
    gc.collect()
    for held in gc.get_objects():
        if issubclass(type(held), ti.Ndarray):
            held.arr = None
        elif issubclass(type(held), pack):
            held._ArgPack__argpack = None


def compiled_kernels() -> list[str]:
    """The kernels of this project, and of what packages add to it, that this process has compiled or taken from the
    cache, as `module.function`."""
    from sim.device.compiler import compiled

    found = []
    ours = ("sim.", *(f"{package}." for package in packages()))
    for module in [module for name, module in sys.modules.items() if name.startswith(ours)]:
        for value in vars(module).values():
            kernel = getattr(value, "_primal", None)
            if kernel is not None and compiled(kernel) and value.__module__ == module.__name__:
                found.append(f"{value.__module__}.{value.__name__}")
    return sorted(found)
