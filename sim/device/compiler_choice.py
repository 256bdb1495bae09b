"""Which compiler kernels are given to: Taichi, unless a developer names one of its forks.

Loads none of them, so a film can be planned by it.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Literal

from scene.settings import Refused

VARIABLE = "TIDEMILL_COMPILER"


@dataclass(frozen=True)
class Compiler:
    """What a compiler is called, and which of our amendments to Taichi it needs or takes.

    `package` is what is installed, `module` what is imported; `compiled` is the attribute of a kernel that holds what
    it has been compiled to. `packs` is how it hands several arguments to a kernel as one, see
    `sim.device.argument_packs`. `relaunch`: calls can be kept and launched again as `sim.device.launching` does.
    """

    module: str
    package: str
    packs: Literal["argpack", "dataclass"]
    relaunch: bool = False
    compiled: str = "compiled_kernels"


COMPILERS = {
    "taichi": Compiler("taichi", "taichi", "argpack", relaunch=True),
    "taichi_forge": Compiler("taichi_forge", "taichi-forge", "argpack", relaunch=True),
    "quadrants": Compiler("quadrants", "quadrants", "dataclass", compiled="materialized_kernels"),
}


def chosen() -> Compiler:
    """The one that `TIDEMILL_COMPILER` names; raises Refused where there is no such one."""
    name = os.environ.get(VARIABLE) or "taichi"
    if name not in COMPILERS:
        raise Refused(f"{VARIABLE}={name} names no compiler", remedy=f"set it to one of {', '.join(COMPILERS)}")
    return COMPILERS[name]
