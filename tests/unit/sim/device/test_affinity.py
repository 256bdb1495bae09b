"""Threads are bound to processors only where a run has all of them."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterator

import pytest

from sim.device.affinity import bound

pytestmark = pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="threads cannot be bound here")


@contextlib.contextmanager
def freed() -> Iterator[list[int]]:
    """Use all processors: a worker of pytest-xdist has one (tests/conftest.py)."""
    own = os.sched_getaffinity(0)
    os.sched_setaffinity(0, range(os.cpu_count() or 1))
    try:
        yield sorted(os.sched_getaffinity(0))
    finally:
        os.sched_setaffinity(0, own)


def processors() -> list[int]:
    if not hasattr(os, "sched_getaffinity"):
        return []
    with freed() as found:
        return found


ALL = processors()


@pytest.fixture(autouse=True)
def free():
    with freed():
        yield


def affinities(threads: int) -> list[set[int]]:
    """Of as many threads as there are processors, started within."""
    done = threading.Event()
    started = [threading.Thread(target=done.wait) for _ in ALL]
    try:
        with bound(threads):
            for thread in started:
                thread.start()
        return [os.sched_getaffinity(thread.native_id) for thread in started]
    finally:
        done.set()


@pytest.mark.skipif(len(ALL) < 2, reason="one processor")
def test_each_thread_has_a_processor_where_there_are_as_many():
    assert sorted(affinities(len(ALL)), key=min) == [{processor} for processor in ALL]
    assert os.sched_getaffinity(0) == set(ALL)


@pytest.mark.parametrize("threads", [1, len(ALL) + 1])
def test_threads_are_free_where_others_share_the_machine(threads):
    assert affinities(threads) == [set(ALL)] * len(ALL)
