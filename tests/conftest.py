"""Shared by all tests: a small world to simulate in, and Taichi running."""

from __future__ import annotations

import argparse
import os
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from unittest import mock

import pytest

from tests import rounding as variants

ROUNDING = f"""run each test of verification, validation and stress that is chosen once for each of
{", ".join(variants.VARIANTS)}, which stand for the rounding of another processor: starts displaced by 1e-6 of the
spacing of particles, two threads, and sums in the order in which they are written; other tests are left out"""
THIN = "run one in N cases of each test, and at least one: all of the slow tests take a night on two cores"
SLOWEST = 3600
"""What a slow test may take [s]: a machine that does other things meanwhile should not decide."""
_shared: list[Callable[[], None]] = []
"""What ends the fixtures that tests share under the present variant."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--rounding", action="store_true", help=ROUNDING)
    parser.addoption("--thin", type=_at_least_one, default=1, metavar="N", help=THIN)
    parser.addoption("--arch", choices=("cpu", "cuda"), default="cpu", help="what simulates within tests (cpu)")


def _at_least_one(text: str) -> int:
    if int(text) < 1:
        raise argparse.ArgumentTypeError("must be at least 1")
    return int(text)


def pytest_configure(config: pytest.Config) -> None:
    """Give each of several processes that test side by side a processor of its own, where there are as many: threads
    of two that share all would wait for one another most of the time."""
    worker = os.environ.get("PYTEST_XDIST_WORKER")
    if worker is None or not hasattr(os, "sched_setaffinity"):
        return
    processors = sorted(os.sched_getaffinity(0))
    if len(processors) >= int(os.environ["PYTEST_XDIST_WORKER_COUNT"]):
        os.sched_setaffinity(0, {processors[int(worker.removeprefix("gw")) % len(processors)]})


@pytest.hookimpl(wrapper=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> Iterator[None]:
    if config.getoption("--rounding"):
        rest = [item for item in items if not _simulates(item.path)]
        config.hook.pytest_deselected(items=rest)
        items[:] = [item for item in items if item not in rest]
    for item in items:
        if item.get_closest_marker("slow") and not item.get_closest_marker("timeout"):
            item.add_marker(pytest.mark.timeout(SLOWEST))
    yield
    _thin_out(config, items)


def _thin_out(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep every N-th case of each test, of those that marks and names have chosen."""
    seen: Counter[str] = Counter()
    kept, left = [], []
    for item in items:
        test = item.nodeid.partition("[")[0]
        (left if seen[test] % config.getoption("--thin") else kept).append(item)
        seen[test] += 1
    config.hook.pytest_deselected(items=left)
    items[:] = kept


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if metafunc.config.getoption("--rounding") and _simulates(Path(metafunc.module.__file__)):
        metafunc.parametrize("rounding", variants.VARIANTS, indirect=True, scope="session")


def _simulates(file: Path) -> bool:
    return any(folder in file.parents for folder in variants.FOLDERS)


def pytest_fixture_setup(fixturedef: pytest.FixtureDef, request: pytest.FixtureRequest) -> None:
    if fixturedef.scope == "module":
        _shared.append(lambda: fixturedef.finish(request))


@pytest.fixture(scope="session", autouse=True)
def rounding(request: pytest.FixtureRequest) -> Iterator[str | None]:
    """The variant of `--rounding`; when the next one comes, what tests of a module share is made anew."""
    variant = getattr(request, "param", None)
    if variant is None:
        yield None
        return
    with variants.perturbed(variant):
        yield variant
    while _shared:
        _shared.pop()()


@pytest.fixture(scope="session", autouse=True)
def arch(request: pytest.FixtureRequest) -> Iterator[None]:
    """Simulates on what `--arch` names where tests ask for the CPU; commands that they start choose for themselves."""
    chosen = request.config.getoption("--arch")
    if chosen == "cpu":
        yield
        return
    from sim.device import runtime

    start = runtime.start
    with mock.patch.object(runtime, "start", lambda **given: start(**given | {"arch": chosen})):
        yield


@pytest.fixture
def taichi():
    """Taichi, running on the CPU in one thread, as small scenes do: kernels for several are others, and would be
    compiled beside them."""
    from sim.device import runtime

    runtime.start(threads=1, arch="cpu", serial=True)
    from sim.device.compiler import ti

    return ti


@pytest.fixture
def simulate(tmp_path: Path) -> Callable[..., Path]:
    """Simulate a specification given as plain data up to a frame; returns the folder of the results."""
    from sim.segment import simulate as run
    from sim.spec import SimulationSpec

    def call(data: dict[str, Any], last: int, name: str = "run", *, expect: int = 0, **options: Any) -> Path:
        out = tmp_path / name
        options = {"first": 0, "arch": "cpu", "threads": 1, "quiet": True} | options
        assert run(SimulationSpec.model_validate(data), tmp_path, out, last=last, **options) == expect
        return out

    return call
