"""Telling how far a block is: a bar in a terminal, a line a frame elsewhere."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

from tqdm import tqdm


class Progress:
    """Progress on the standard error, with the time left."""

    def __init__(self, total: int):
        self.total = total
        self.done = 0
        self.start = time.perf_counter()
        self.bar = tqdm(total=total, unit="frame", disable=not sys.stderr.isatty())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.bar.close()

    def report(self, event: dict[str, Any]) -> None:
        """Take what happened: `{"frame": 42, "wall_s": 3.1}` after each frame."""
        self.done += 1
        self.bar.update()
        if self.bar.disable:
            left = (time.perf_counter() - self.start) / self.done * (self.total - self.done)
            line = f"frame {event['frame']} ({self.done} of {self.total}): {event['wall_s']:.1f} s, {left:.0f} s left"
            print(line, file=sys.stderr, flush=True)
