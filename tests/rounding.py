"""What stands for the rounding of another processor: `pytest --rounding` runs each test under every one of VARIANTS.

Another processor adds in another order, fuses other products with sums, and has its own last digits of sqrt and exp.
In a flow that amplifies them these are, after a while, as any other disturbance of the last digits: a start that is
displaced by as little, sums by two threads, and sums in the order in which they are written.
"""

from __future__ import annotations

import contextlib
import os
import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

VARIANTS = ("jitter1", "jitter2", "jitter3", "two-threads", "exact-math")
FOLDERS = [Path(__file__).parent / name for name in ("verification", "validation", "stress")]
"""Of the tests that simulate."""
OPTIONS = {"two-threads": {"cpu_max_num_threads": 2}, "exact-math": {"fast_math": False}}
"""What Taichi is started with instead of what production code asks for."""
SHARE = {np.dtype(np.float32): 1e-6, np.dtype(np.float64): 1e-14}
"""How far points are displaced, over the spacing of particles or the size of a body or sheet; by what they are computed
in. Ten units in the last place of single, a hundred of double precision."""
COMMANDS = "TIDEMILL_TESTS_ROUNDING"
"""Environment variable that tells processes of tests the variant."""

_variant: str | None = None


@contextlib.contextmanager
def perturbed(variant: str) -> Iterator[None]:
    """Simulate under one of VARIANTS within; Taichi starts anew before and after, as it is set once."""
    global _variant
    _variant = variant
    try:
        with (
            mock.patch.dict(os.environ, {COMMANDS: variant}),
            _started(OPTIONS[variant]) if variant in OPTIONS else _displaced(int(variant.removeprefix("jitter"))),
        ):
            yield
    finally:
        _variant = None


def segment() -> str:
    """The module that simulates as a command, under the present variant if there is one."""
    return "sim.segment" if _variant is None else __name__


@contextlib.contextmanager
def _started(options: dict[str, Any]) -> Iterator[None]:
    """Taichi starts with other options, now and not when it next has to."""
    from sim.device import runtime
    from sim.device.compiler import ti

    def anew() -> None:
        runtime._running = runtime._running and ("", 0)

    init = ti.init
    anew()
    try:
        with mock.patch.object(ti, "init", lambda **given: init(**given | options)):
            yield
    finally:
        anew()


@contextlib.contextmanager
def _displaced(seed: int) -> Iterator[None]:
    """Fluid, cloth and rigid bodies begin elsewhere by SHARE, the same way each time."""
    import sim.cloth.model
    from sim.rigid.model import RigidModel
    from sim.run.world import World

    pour, begin, place = World.pour, sim.cloth.model._begin, RigidModel._place

    def poured(world: World, state: Any, *given: Any) -> Any:
        found = pour(world, state, *given)
        found.position[state.count :, :3] += _shifts(found.position[state.count :, :3], world.spec.fluid.spacing, seed)
        return found

    def begun(item: Any, state: Any) -> tuple[np.ndarray, np.ndarray]:
        places, velocity = begin(item, state)
        if state.of(item.name) is not None:
            return places, velocity
        return places + ~item.held[:, None] * _shifts(places, np.ptp(places, axis=0).max(), seed), velocity

    def placed(part: RigidModel, state: Any) -> None:
        place(part, state)
        new = part.dynamic & [body.name not in state.names for body in part.bodies]
        part.position[new] += _shifts(part.position[new], part.size[new, None], seed)

    with (
        mock.patch.object(World, "pour", poured),
        mock.patch.object(sim.cloth.model, "_begin", begun),
        mock.patch.object(RigidModel, "_place", placed),
    ):
        yield


def _shifts(places: np.ndarray, length: float | np.ndarray, seed: int) -> np.ndarray:
    """Up to SHARE of a length [m] along each axis, or the last digit of the greatest coordinate where that is more."""
    last = np.spacing(np.abs(places).max(initial=0))
    most = np.maximum(SHARE[places.dtype] * length, last)
    return most * np.random.default_rng(seed).uniform(-1, 1, places.shape)


if __name__ == "__main__":
    with perturbed(os.environ[COMMANDS]):
        runpy.run_module("sim.segment", run_name="__main__", alter_sys=True)
