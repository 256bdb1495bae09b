"""The events that are played in: which there are, which have happened, and who is told where one is refused."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from scene.events import TIME_TOLERANCE, apply

if TYPE_CHECKING:
    from sim.run.stepping import Run
    from sim.spec import Event, SimulationSpec

Answer = Callable[[str], None]
"""Told what was wrong; not called where nothing was."""


class PlayedEvents:
    """In the order in which they came; all of them are events of the run's spec, too."""

    def __init__(self) -> None:
        self._events: list[Event] = []
        self._refusals: dict[int, Answer] = {}
        self.applied_until = -1.0
        """Events up to this time [s] have happened."""

    @property
    def waiting(self) -> int:
        """How many happen with the next steps."""
        return sum(event.at > self.applied_until + TIME_TOLERANCE for event in tuple(self._events))

    def bring_in(self, event: Event, run: Run, refused: Answer) -> None:
        """Let an event happen, and tell `refused` if it cannot."""
        run.bring_in(event)
        self._events.append(event)
        self._refusals[id(event)] = refused

    def upcoming(self, spec: SimulationSpec) -> SimulationSpec:
        """The settings in force, now `spec`, once everything has happened that is on its way."""
        for index, event in enumerate(self._events):
            if event.at > self.applied_until + TIME_TOLERANCE:
                spec = apply(spec, event, index)
        return spec

    def forget_from(self, time: float, run: Run) -> None:
        """Take out what happens at `time` [s] or later."""
        self._forget({id(event) for event in self._events if event.at > time - TIME_TOLERANCE}, run)

    def refuse(self, why: str, run: Run) -> bool:
        """Take out the last of those that happen now, and tell who asked for it; whether there was any."""
        now = [event for event in self._events if abs(event.at - run.clock.time) < TIME_TOLERANCE]
        if not now:
            return False
        self._refusals.pop(id(now[-1]), lambda text: None)(why)
        self._forget({id(now[-1])}, run)
        return True

    def accept(self) -> None:
        """All that have happened were good."""
        self._refusals.clear()

    def _forget(self, gone: set[int], run: Run) -> None:
        self._events = [event for event in self._events if id(event) not in gone]
        kept = tuple(event for event in run.spec.events if id(event) not in gone)
        run.spec = run.spec.model_copy(update={"events": kept})
