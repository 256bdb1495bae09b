"""What a state file says besides its arrays, as typed settings: a file that says anything else is no state."""

from __future__ import annotations

from typing import Annotated, Any

from annotated_types import Ge, Gt, Le
from pydantic import Strict

from scene.settings import Settings

Whole = Annotated[int, Ge(0), Strict()]
Time = Annotated[float, Ge(0), Strict()]
"""[s]"""


class ClockHead(Settings):
    """Where the run stands in time."""

    frame: Whole
    time: Time
    step: Whole
    last_step: Time
    step_scale: Annotated[float, Gt(0), Le(1), Strict()]


class SentHead(Settings):
    """What an emitter has sent."""

    number: Whole
    layers: Annotated[float, Strict()]
    warned: bool


class EmissionHead(Settings):
    """What emitters have to remember."""

    sent: dict[str, SentHead] = {}
    full: bool = False


class GatheredHead(Settings):
    """What a probe that tells means has gathered."""

    since: Time
    until: Time
    sums: tuple[Annotated[float, Strict()], ...]
    impulse: tuple[Annotated[float, Strict()], ...]


class Head(Settings):
    """All of it."""

    format: Whole
    clock: ClockHead
    counts: dict[str, Whole]
    probe_times: dict[str, Time]
    probe_means: dict[str, GatheredHead] = {}
    emission: EmissionHead = EmissionHead()
    sources: tuple[str, ...] = ()
    layout: dict[str, Any]
    one_thread: Annotated[bool, Strict()] = False
    dynamic_bodies: tuple[str, ...] | None = None
    sheets: tuple[tuple[str, Whole], ...] | None = None
