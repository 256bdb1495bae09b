"""Wall time by phase."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator


class Stopwatch:
    """Seconds spent in each named phase.

    `apart`: clocks [s] of what happens within phases and counts as a phase of its own, by its name.
    """

    def __init__(self, **apart: Callable[[], float]) -> None:
        self._start = time.perf_counter()
        self._apart = apart
        self.seconds: dict[str, float] = {}

    def _add(self, phase: str, seconds: float) -> None:
        self.seconds[phase] = self.seconds.get(phase, 0.0) + seconds

    @contextlib.contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Time what is done within, less what other clocks of `apart` count of it: that is added to their phases."""
        clocks = {other: clock for other, clock in self._apart.items() if other != name}
        start, before = time.perf_counter(), {other: clock() for other, clock in clocks.items()}
        try:
            yield
        finally:
            within = {other: clock() - before[other] for other, clock in clocks.items()}
            self._add(name, time.perf_counter() - start - sum(within.values()))
            for other, seconds in within.items():
                if seconds:
                    self._add(other, seconds)

    def rounded(self) -> dict[str, float]:
        """Seconds by phase."""
        return {phase: round(seconds, 4) for phase, seconds in self.seconds.items()}

    def report(self) -> dict[str, float]:
        """Seconds by phase, and the total since the start."""
        return self.rounded() | {"total": round(time.perf_counter() - self._start, 4)}
