"""Shared by all tests: a small world to simulate in, and Taichi running."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest


def pytest_configure(config: pytest.Config) -> None:
    """Give each of several processes that test side by side a processor of its own, where there are as many: threads
    of two that share all would wait for one another most of the time."""
    worker = os.environ.get("PYTEST_XDIST_WORKER")
    if worker is None or not hasattr(os, "sched_setaffinity"):
        return
    processors = sorted(os.sched_getaffinity(0))
    if len(processors) >= int(os.environ["PYTEST_XDIST_WORKER_COUNT"]):
        os.sched_setaffinity(0, {processors[int(worker.removeprefix("gw"))]})


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
