"""Telling how far a block is: a bar in a terminal, a line a frame elsewhere."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Any, Self

from tqdm import tqdm

from common.time_left import BAR, TimeLeft


class Progress:
    """Progress on the standard error, with the time left."""

    def __init__(self, total: int):
        self.total = total
        self.done = 0
        self.left = TimeLeft(total)
        self.bar = tqdm(total=total, unit="frame", disable=not sys.stderr.isatty(), bar_format=BAR)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.bar.close()

    def report(self, event: dict[str, Any]) -> None:
        """Take what happened: `{"frame": 42, "wall_s": 3.1}` after each frame."""
        self.done += 1
        self.left.took(event["wall_s"])
        self.bar.set_postfix_str(f"{event['wall_s']:.1f} s a frame{self.left}", refresh=False)
        self.bar.update()
        if self.bar.disable:
            line = f"frame {event['frame']} ({self.done} of {self.total}): {event['wall_s']:.1f} s{self.left}"
            print(line, file=sys.stderr, flush=True)
