"""Signals that end a run, and who hears them.

Python hears a signal between two of its instructions, and one of them may take long: Taichi compiles a kernel for up to
ten seconds, and lets no other thread of Python do anything meanwhile. So what writes nothing leaves signals to the
system, which ends it at once.
"""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from typing import Any

Handler = Callable[[int, Any], None] | signal.Handlers

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
INTERRUPTED = 130


@contextlib.contextmanager
def handled(handler: Handler) -> Iterator[None]:
    """Signals that end a run go to `handler`; in a thread, to whom they went before."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    hand_over(handler)
    try:
        yield
    finally:
        for number, previous in before.items():
            signal.signal(number, previous)


def at_once() -> contextlib.AbstractContextManager[None]:
    """A signal ends the process at once: for what takes long and writes nothing."""
    return handled(signal.SIG_DFL)


def are_at_once() -> bool:
    """Whether a signal would end the process at once."""
    on_main = threading.current_thread() is threading.main_thread()
    return on_main and all(signal.getsignal(number) == signal.SIG_DFL for number in SIGNALS)


def hand_over(handler: Handler) -> None:
    """From now on signals that end a run go to `handler`; from the main thread only."""
    for number in SIGNALS:
        signal.signal(number, handler)
