"""What tests that hold for every pressure solver share: the solvers' names and a run in a process of its own kind."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tests.particles import read_table

SOLVERS = ("wcsph", "pcisph", "iisph", "dfsph")
INCOMPRESSIBLE = SOLVERS[1:]
ITERATIVE = ("iisph", "dfsph")


def run(data: dict[str, Any], out: Path, last: int) -> Path:
    """Simulate a specification given as plain data up to a frame, on one thread; returns the folder of the results."""
    from sim.segment import simulate
    from sim.spec import SimulationSpec

    spec = SimulationSpec.model_validate(data)
    assert simulate(spec, out, out, first=0, last=last, arch="cpu", threads=1, quiet=True) == 0
    return out


def steps(out: Path) -> np.ndarray:
    """The table steps.csv."""
    return read_table(out / "steps.csv")


def probe(out: Path, name: str, quantity: str | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and values of one probe."""
    table = read_table(out / "probes.csv")
    chosen = table["probe"] == name
    if quantity is not None:
        chosen &= table["quantity"] == quantity
    return table["time"][chosen], table["value"][chosen]
