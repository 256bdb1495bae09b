"""Shared by all tests: a small world to simulate in, and Taichi running."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def taichi():
    """Taichi, running on the CPU."""
    from sim import runtime

    runtime.start(threads=2, arch="cpu")
    import taichi as ti

    return ti


@pytest.fixture
def simulate(tmp_path: Path) -> Callable[..., Path]:
    """Simulate a specification given as plain data up to a frame; returns the folder of the results."""
    from sim.segment import simulate as run
    from sim.spec import SimulationSpec

    def call(data: dict[str, Any], last: int, name: str = "run", *, expect: int = 0, **options: Any) -> Path:
        out = tmp_path / name
        options = {"first": 0, "arch": "cpu", "quiet": True} | options
        assert run(SimulationSpec.model_validate(data), tmp_path, out, last=last, **options) == expect
        return out

    return call
