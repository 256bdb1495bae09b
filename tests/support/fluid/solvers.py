"""What tests that hold for every pressure solver share: names, runs on one thread, and tables."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests.support.in_time import in_time
from tests.support.particles import read_table

SOLVERS = ("wcsph", "pcisph", "iisph", "dfsph")
INCOMPRESSIBLE = SOLVERS[1:]
ITERATIVE = ("iisph", "dfsph")
STRESSED = ("wcsph", "dfsph", *in_time("pcisph", "iisph"))
"""For the extremes, of which there are many: the two that share their parts with these only where there is time."""
LONG = ("dfsph", *in_time("wcsph", "pcisph", "iisph"))
"""For scenes that take long with each."""


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


def run_changed(data: dict[str, Any], out: Path, last: int, change: Callable[..., np.ndarray], after: int = 0) -> Path:
    """`run` with velocities [m/s] that no scene can give, set after frame `after`: positions [m] and velocities in,
    shape [n, 3] each, velocities out.

    They are written into the state between two runs; tables begin anew there.
    """
    from sim.segment import simulate
    from sim.spec import SimulationSpec

    run(data, out, after)
    kept = out / f"state_{after:05d}.npz"
    with np.load(kept) as stored:
        state = {name: stored[name] for name in stored.files}
    place, speed = state["fluid.position"], state["fluid.velocity"]
    speed[:, :3] = change(place[:, :3].astype(float) + state["origin"], speed[:, :3].astype(float))
    np.savez(kept, **state)
    spec = SimulationSpec.model_validate(data)
    options = {"first": after + 1, "last": last, "state": kept, "arch": "cpu", "threads": 1, "quiet": True}
    assert simulate(spec, out, out, **options) == 0
    return out
