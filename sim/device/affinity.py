"""Threads kept to a processor each, where a run has all processors to itself.

The loops of a step take fractions of a millisecond. Schedulers that gather what wakes up on one processor, to let
others sleep, leave the second thread waiting for a large part of each.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

TASKS = Path("/proc/self/task")


@contextlib.contextmanager
def bound(threads: int) -> Iterator[None]:
    """Bind the threads that start within, in turns, to the processors that this process may use.

    Only where these are as many as `threads`: with fewer, other jobs share the machine, and whose processors those are
    is not known. Does nothing where the system does not tell of threads.
    """
    before = _threads()
    yield
    processors = sorted(os.sched_getaffinity(0)) if before else []
    if 1 < threads == len(processors):
        for number, thread in enumerate(sorted(_threads() - before)):
            with contextlib.suppress(OSError):
                os.sched_setaffinity(thread, {processors[number % threads]})


def _threads() -> set[int]:
    return {int(task.name) for task in TASKS.iterdir()} if TASKS.is_dir() else set()
