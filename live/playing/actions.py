"""What viewers ask for, until the simulation can do it."""

from __future__ import annotations

import queue
from collections.abc import Callable

from live.playing.played import Answer

MOST_WAITING = 200
"""Actions that may wait for the next step."""


class WaitingActions:
    """Added by any thread, carried out in that of the simulation, in their order."""

    def __init__(self) -> None:
        self._queue: queue.Queue[Callable[[], None]] = queue.Queue(MOST_WAITING)

    def add(self, action: Callable[[], None], refused: Answer | None = None) -> None:
        """Let an action wait for its turn; tells `refused` where there are too many."""
        try:
            self._queue.put_nowait(action)
        except queue.Full:
            if refused:
                refused("too many actions wait for the simulation: wait for it")

    def carry_out_next(self, wait: float = 0.0) -> bool:
        """Carry out the next one, which may still come for some time [s]; whether there was one."""
        try:
            action = self._queue.get(wait > 0, wait)
        except queue.Empty:
            return False
        action()
        return True
