"""How long what is made frame by frame will still take."""

from __future__ import annotations

from collections import deque

BAR = "{l_bar}{bar}| {n_fmt}/{total_fmt} [{elapsed}{postfix}]"
"""tqdm's, without its own time left, which counts what is compiled and loaded in the first frames."""
RECENT = 4
"""Frames that an estimate goes by: what they cost changes while a film goes on, as when a drop meets the floor."""


class TimeLeft:
    """Estimate for `total` frames from what the last ones took.

    The first one is left out: it is the start of a film, or pays for what is loaded and compiled.
    """

    def __init__(self, total: int):
        self._left = total
        self._taken: deque[float] = deque(maxlen=RECENT)
        self._first = True

    def took(self, seconds: float) -> None:
        """A frame is done, after work of `seconds` without compilation."""
        self._left -= 1
        if not self._first:
            self._taken.append(seconds)
        self._first = False

    @property
    def seconds(self) -> float | None:
        """Those that are left; None where that cannot be known yet, and at the end."""
        if not self._taken or not self._left:
            return None
        return self._left * sum(self._taken) / len(self._taken)

    def __str__(self) -> str:
        """As `, about 12 min left`; empty where nothing can be said."""
        return "" if self.seconds is None else f", about {duration(self.seconds)} left"


def duration(seconds: float) -> str:
    """As `1 h 05 min`, `12 min`, `40 s`."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"
