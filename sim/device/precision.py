"""Single or double precision: chosen once a process, before the first kernel is imported.

Kernels carry the type of their arguments from the moment they are defined.
"""

from __future__ import annotations

import sys

from scene.settings import Refused

chosen = "single"


def choose(name: str) -> None:
    """Compute in "single" or "double" precision; raises Refused where the process has begun with the other."""
    global chosen
    if name != chosen and "sim.device.arrays" in sys.modules:
        raise Refused(
            f"this process computes in {chosen} precision already",
            location=("precision",),
            remedy="use a process of its own for each precision",
        )
    chosen = name
