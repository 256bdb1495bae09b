"""What one client asks for: done where it steers, in the order in which it was asked."""

from __future__ import annotations

import logging
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import viser

log = logging.getLogger(__name__)
Action = Callable[[], None]
Callback = Callable[["viser.GuiEvent"], Coroutine[None, None, None]]


class Orders:
    """One thread for all that a client asks for: among those of viser a click may overtake another.

    `may` says whether the client steers; `tell` shows it a message.
    """

    def __init__(self, may: Callable[[], bool], tell: Callable[[str], None]):
        self._may, self._tell = may, tell
        self._thread = ThreadPoolExecutor(1, "orders")

    def steering(self, action: Action) -> Callback:
        """A callback for viser: the action of one that steers, after all that it asked for before."""
        return self.queued(lambda event: self.steer(event, action))

    def queued(self, action: Callable[[viser.GuiEvent], None]) -> Callback:
        """A callback for viser: the action of anybody, after all that was asked for before."""

        async def asked(event: viser.GuiEvent) -> None:
            self._thread.submit(_carry_out, action, event)

        return asked

    def finish(self, seconds: float) -> None:
        """Wait for what was asked for until now, no longer than that [s]."""
        wait([self._thread.submit(int)], seconds)

    def steer(self, event: viser.GuiEvent | viser.TransformControlsEvent, action: Action) -> None:
        """Act at once, if the client steers; what no client asked for is no order."""
        if event.client_id is None:
            return
        if self._may():
            action()
        else:
            self._tell("somebody else steers this simulation: press Take over first")


def _carry_out(action: Callable[[viser.GuiEvent], None], event: viser.GuiEvent) -> None:
    try:
        action(event)
    except Exception:
        log.exception("what client %s asked for failed", event.client_id)
