"""How long a step is, and when an event may come in between two of them."""

from __future__ import annotations

import math

from scene.events import TIME_TOLERANCE
from sim.spec import TimeStep

GROWTH = 1.1
"""A step is at most this much longer than the one before: it falls at once and rises slowly."""
ROUNDING = 1e-9
"""Events that come in while a run steps are so long [s] after what is settled."""
LONGEST_STEP = 1.0
"""The step [s] where nothing limits it; frames and events cut it."""


def wanted_step(settings: TimeStep, limit: float, last: float) -> float:
    """The step [s] before the end of a frame cuts it; `limit` [s] is the largest stable one, `last` [s] the one before,
    0 at the start."""
    if settings.fixed is not None:
        return settings.fixed
    limits = [limit, LONGEST_STEP]
    if settings.maximum is not None:
        limits.append(settings.maximum)
    if last > 0:
        limits.append(GROWTH * last)
    return min(limits)


def fit(step: float, rest: float, *, even: bool) -> float:
    """The step that lands on the end of `rest` [s]; `even` shares the last two steps out evenly.

    What is left of a frame is a difference of times, so that it may be a rounding error longer than a step that fits
    into it exactly.
    """
    if step >= rest - TIME_TOLERANCE:
        return rest
    return rest / 2 if even and 2 * step > rest + TIME_TOLERANCE else step


def landing(until: float, keyframe: float) -> float:
    """The time [s] to land on before `until`: no `keyframe`, where the velocity of a body jumps, is stepped over."""
    return keyframe if keyframe < until - TIME_TOLERANCE else until


class EventWindow:
    """From when on an event can come into a frame as if it had been known from the start: steps are shared out evenly
    up to the next event, so that one that is near would have changed those taken until now."""

    def __init__(self) -> None:
        self.opens = 0.0
        """The earliest time [s] of this frame at which an event would not have changed the steps taken until now;
        infinite where there is none."""
        self._repeated = False

    def begin_frame(self, time: float, *, repeated: bool) -> None:
        """At `time` [s]; into a frame that is repeated nothing comes in: what was tried before would have met it."""
        self._repeated = repeated
        self.opens = math.inf if repeated else time

    def earliest(self, known: list[float], end: float, last_step: float) -> float:
        """The earliest time [s] for an event that comes in: with one of the `known` in the rest of the frame, or when
        the window opens; but the `end` of the frame where less than half of `last_step` [s] is left then."""
        at = min([self.opens, *known])
        return at if self.opens < math.inf and at < end - 0.5 * last_step else end

    def step(self, time: float, longest: float, *, even: bool) -> None:
        """A step begins at `time` [s] that may have been `longest` [s]."""
        settled = self.opens if self.opens < math.inf or self._repeated else 0.0
        self.opens = max(settled, time + (2 if even else 1) * longest + ROUNDING)

    def meet(self, time: float, last_step: float) -> None:
        """Events happened at `time` [s]. Sooner than after a step like the last one, of `last_step` [s], the next step
        would be next to nothing."""
        self.opens = max(self.opens, time + last_step) if last_step else math.inf
