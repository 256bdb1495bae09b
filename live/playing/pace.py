"""How fast a run goes by the clock on the wall, and how fast it may."""

from __future__ import annotations

import time
from collections import deque

LONGEST_WAIT = 0.1
"""At a time [s], so that actions do not have to wait."""


class Pace:
    """Of one run; times are simulated [s]."""

    def __init__(self) -> None:
        self.most: float | None = None
        """Simulated over wall-clock time at most; without it, as fast as it goes."""
        self._from = (0.0, 0.0)
        self._recent: deque[tuple[float, float]] = deque(maxlen=30)

    def limit(self, most: float | None, at: float) -> None:
        """Go no faster than `most`, from here on."""
        self.most = most
        self.start(at)

    def start(self, at: float) -> None:
        """Count from here."""
        self._from = (time.perf_counter(), at)
        self._recent.clear()

    def keep(self, at: float) -> None:
        """Wait where the run is ahead of its pace."""
        if self.most is None:
            return
        wall, simulated = self._from
        ahead = (at - simulated) / self.most - (time.perf_counter() - wall)
        if ahead > 0:
            time.sleep(min(ahead, LONGEST_WAIT))

    def step(self, at: float) -> None:
        """A step was taken."""
        self._recent.append((time.perf_counter(), at))

    def rates(self) -> tuple[float, float]:
        """Steps per second, and simulated over wall-clock time, of the last steps."""
        if len(self._recent) < 2:
            return 0.0, 0.0
        (began, simulated), (now, until) = self._recent[0], self._recent[-1]
        wall = max(now - began, 1e-9)
        return (len(self._recent) - 1) / wall, (until - simulated) / wall
