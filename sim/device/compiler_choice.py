"""Which compiler kernels are given to: Taichi, unless a developer names one of its forks.

Loads none of them, so a film can be planned by it.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Literal

from scene.settings import Refused

VARIABLE = "TIDEMILL_COMPILER"


@dataclass(frozen=True)
class Compiler:
    """What a compiler is called, and which of our amendments to Taichi it needs or takes.

    `package` is what is installed, `module` what is imported; `compiled` is the attribute of a kernel that holds what
    it has been compiled to. `packs` is how it hands several arguments to a kernel as one, see
    `sim.device.argument_packs`. `relaunch`: calls can be kept and launched again as `sim.device.launching` does;
    `memoize`: what it does in Python for each kernel can be done once, as by `sim.device.tracing`; `serial`: its loops
    can be told to run in the thread that launches them, as by `sim.device.serial_loops`.
    `options` are what it is started with besides those of Taichi.
    """

    module: str
    package: str
    packs: Literal["argpack", "dataclass"]
    relaunch: bool = False
    memoize: bool = False
    serial: bool = False
    compiled: str = "compiled_kernels"
    options: dict[str, str] = field(default_factory=dict)


COMPILERS = {
    "taichi": Compiler("taichi", "taichi", "argpack", relaunch=True, memoize=True, serial=True),
    # It optimizes little unless told to.
    "taichi_forge": Compiler("taichi_forge", "taichi-forge", "argpack", options={"compile_tier": "full"}),
    "quadrants": Compiler("quadrants", "quadrants", "dataclass", compiled="materialized_kernels"),
}


def chosen() -> Compiler:
    """The one that `TIDEMILL_COMPILER` names; raises Refused where there is no such one."""
    name = os.environ.get(VARIABLE) or "taichi"
    if name not in COMPILERS:
        raise Refused(f"{VARIABLE}={name} names no compiler", remedy=f"set it to one of {', '.join(COMPILERS)}")
    return COMPILERS[name]
