"""Progress with the time left: a bar on a terminal, a line a frame elsewhere."""

from __future__ import annotations

import contextlib
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.stepping import Run


class Progress:
    """Frames `first` to `last`."""

    def __init__(self, first: int, last: int, *, quiet: bool = False):
        from tqdm import tqdm

        self.quiet = quiet
        self.total = last - first + 1
        self.began = time.perf_counter()
        self.done = 0
        terminal = sys.stderr.isatty() and not quiet
        self.bar = tqdm(total=self.total, unit="frame", desc="simulate", dynamic_ncols=True) if terminal else None

    def update(self, run: Run) -> None:
        self.done += 1
        particles = run.world.fluid.count if run.world.fluid else 0
        state = f"t {run.clock.time:.3f} s, {run.steps_taken} steps, {particles:,} particles"
        if self.bar is not None:
            self.bar.set_postfix_str(state, refresh=False)
            self.bar.update()
        elif not self.quiet:
            elapsed = time.perf_counter() - self.began
            left = elapsed / self.done * (self.total - self.done)
            _print(f"frame {run.clock.frame}: {state}; {self.done}/{self.total}, {left:.0f} s left")

    def say(self, message: str) -> None:
        if self.bar is not None:
            self.bar.write(message, file=sys.stderr)
        else:
            _print(message)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()


def _print(message: str) -> None:
    """A run goes on when nobody listens any more."""
    with contextlib.suppress(BrokenPipeError):
        print(message, file=sys.stderr, flush=True)
