"""What a run keeps in memory: at most 1 kB a particle, with lists of neighbours, all of it counted; no step adds."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from tests.stress.scenes import assert_nothing_broken
from tests.support.fluid.solvers import LONG

MOST = 1000
"""Bytes a particle."""


@pytest.mark.parametrize("solver", LONG)
def test_a_particle_takes_a_kilobyte_at_most(simulate, solver):
    """27 000 particles in half of a box with plane walls, whose lists have grown as far as they will at rest."""
    side = 0.6
    scene = {
        "fps": 1000,
        "containers": {"tank": {"type": "box", "size": [side, side, side]}},
        "fluid": {
            "solver": solver,
            "particle_radius": 0.01,
            "bodies": {"pool": {"shape": {"type": "box", "size": [side, side, side]}, "position": [0, side / 2, 0]}},
        },
    }
    out = simulate(scene, 1, threads=1)
    assert_nothing_broken(out)
    told = json.loads((out / "summary.json").read_text())
    count = told["counts"]["particles"]
    assert count == 27_000
    lists = 4 * 30
    assert lists * count < told["bytes"]["fluid"] <= MOST * count
    print(f"{solver}: {told['bytes']['fluid'] / count:.0f} bytes a particle")


def test_steps_keep_no_memory(simulate, monkeypatch):
    """Taichi never gives back what it compiles to fill an array of vectors, nor all that it takes to make one: so no
    step may do either, once the lists have grown, with cloth that is led, water, and a ball on both."""
    from sim.device.compiler import ti

    calls: list[str] = []
    for kind in (ti.lang.matrix.MatrixNdarray, ti.lang.matrix.VectorNdarray):
        for name in ("__init__", "_fill_by_kernel"):
            monkeypatch.setattr(kind, name, counted(getattr(kind, name), calls))
    led = [{"at": "left", "velocity": [0, 0.05, 0]}, "right"]
    sheet = {"shape": {"type": "sheet", "size": [0.4, 0.4]}, "spacing": 0.05, "position": [0, 0.2, 0], "pins": led}
    ball = {"shape": {"type": "sphere", "radius": 0.05}, "position": [0, 0.26, 0], "motion": "dynamic"}
    water = {"shape": {"type": "box", "size": [0.4, 0.16, 0.4]}, "position": [0, 0.08, 0]}
    scene = {
        "fps": 25,
        "containers": {"tank": {"type": "box", "size": [0.4, 0.4, 0.4]}},
        "fluid": {"solver": "dfsph", "particle_radius": 0.02, "bodies": {"water": water}},
        "rigid": {"bodies": {"ball": ball}},
        "cloth": {"sheets": {"sheet": sheet}},
    }
    made = []
    for last in (1, 3):
        calls.clear()
        simulate(scene, last, str(last), threads=1)
        made.append(len(calls))
    assert made[0] > 50, "nothing was counted"
    assert made[1] <= made[0] + 20


def counted(method: Callable[..., Any], calls: list[str]) -> Callable[..., Any]:
    """The same, noted in `calls`."""

    def call(*given: Any, **settings: Any) -> Any:
        calls.append(method.__qualname__)
        return method(*given, **settings)

    return call
