"""Wall time by phase."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

from sim.device import compilation

COMPILE = "compile"


class Stopwatch:
    """Seconds spent in each named phase; kernels that are compiled in one count as a phase of their own."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def _add(self, phase: str, seconds: float) -> None:
        self.seconds[phase] = self.seconds.get(phase, 0.0) + seconds

    @contextlib.contextmanager
    def phase(self, name: str) -> Iterator[None]:
        start, compiled = time.perf_counter(), compilation.seconds()
        try:
            yield
        finally:
            compiling = 0.0 if name == COMPILE else compilation.seconds() - compiled
            self._add(name, time.perf_counter() - start - compiling)
            if compiling:
                self._add(COMPILE, compiling)

    def rounded(self) -> dict[str, float]:
        return {phase: round(seconds, 4) for phase, seconds in self.seconds.items()}
