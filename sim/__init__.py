"""Simulation of fluids, rigid bodies and cloth."""

import os

for _compiler in ("TAICHI", "QUADRANTS"):
    os.environ.setdefault(f"ENABLE_{_compiler}_HEADER_PRINT", "0")
if "HOME" not in os.environ:
    # As for daemons and batch jobs: without it Taichi aborts when it is imported.
    _home = os.path.expanduser("~")
    os.environ["HOME"] = _home if os.path.isabs(_home) else os.devnull
