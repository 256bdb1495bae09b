"""Simulation of fluids, rigid bodies and cloth."""

import os

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
os.environ.setdefault("ENABLE_QUADRANTS_HEADER_PRINT", "0")
if "HOME" not in os.environ:
    # As for daemons and batch jobs: without it Taichi aborts when it is imported.
    _home = os.path.expanduser("~")
    os.environ["HOME"] = _home if os.path.isabs(_home) else os.devnull
