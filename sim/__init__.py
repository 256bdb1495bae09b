"""Simulation of fluids, rigid bodies and cloth."""

import os

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
