"""Progress with the time left: a bar on a terminal, a line a frame elsewhere."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

from common.time_left import BAR, TimeLeft
from sim.device import compilation

if TYPE_CHECKING:
    from sim.run.stepping import Run


class Progress:
    """Frames `first` to `last`."""

    def __init__(self, first: int, last: int, *, quiet: bool = False):
        from tqdm import tqdm

        self.quiet = quiet
        self.total = last - first + 1
        self.left = TimeLeft(self.total)
        self.done = 0
        self._last = _worked()
        terminal = sys.stderr.isatty() and not quiet
        self.bar = (
            tqdm(total=self.total, unit="frame", desc="simulate", dynamic_ncols=True, bar_format=BAR)
            if terminal
            else None
        )

    def update(self, run: Run) -> None:
        """Say that one more frame is done, and where the run stands."""
        self.done += 1
        now = _worked()
        self.left.took(now - self._last)
        self._last = now
        particles = run.world.fluid.count if run.world.fluid else 0
        state = f"t {run.clock.time:.3f} s, {run.steps_taken} steps, {particles:,} particles"
        if self.bar is not None:
            self.bar.set_postfix_str(f"{state}{self.left}", refresh=False)
            self.bar.update()
        elif not self.quiet:
            print(f"frame {run.clock.frame}: {state}; {self.done}/{self.total}{self.left}", file=sys.stderr, flush=True)

    def say(self, message: str) -> None:
        """Print a line to standard error, above the bar where there is one."""
        if self.bar is not None:
            self.bar.write(message, file=sys.stderr)
        else:
            print(message, file=sys.stderr, flush=True)

    def close(self) -> None:
        """End the bar, where there is one."""
        if self.bar is not None:
            self.bar.close()


def _worked() -> float:
    """A clock [s] that stands still while kernels are compiled."""
    return time.perf_counter() - compilation.seconds()
