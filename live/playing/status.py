"""How a session stands, as its viewers are told."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Status:
    """How a session stands."""

    mode: Literal["starting", "paused", "playing", "closed"] = "starting"
    frame: int = 0
    time: float = 0.0
    particles: int = 0
    factor: float = 0.0
    """Simulated over wall-clock time."""
    steps_per_second: float = 0.0
    problem: str = ""
    """Why the simulation stopped, and what would help."""
    kept: tuple[int, int] = (0, 0)
    """First and last frame that can be gone back to."""
