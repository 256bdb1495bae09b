"""What viewers see of a run: its last picture, what is the same in all of them, and its course."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from live.playing.picture import Course, Picture, Scenery, picture, scenery

if TYPE_CHECKING:
    from sim.run.stepping import Run
    from sim.run.world import World

PICTURES = 1 / 25
"""Shortest time between two pictures [s]."""


class Display:
    """Drawn in the thread of the simulation, read by any."""

    def __init__(self) -> None:
        self.picture: Picture | None = None
        self.scenery = Scenery()
        self.course = Course()
        self.watched = False
        """Whether anybody looks at pictures."""
        self.seen: World | None = None
        """The world whose scenery it is."""
        self._drawn, self._drawn_at = (-1, -1), 0.0

    @property
    def due(self) -> bool:
        """Whether it is time for another picture."""
        return self.watched and time.perf_counter() - self._drawn_at >= PICTURES

    def look_around(self, world: World) -> None:
        """See what stays the same in pictures of a world."""
        self.seen = world
        self.scenery = scenery(world, self.scenery.number + 1)
        self._drawn = (-1, -1)

    def draw(self, run: Run) -> Picture | None:
        """Make a picture; None where it would be the one there is."""
        if self._drawn == (run.clock.frame, run.clock.step):
            return None
        drawn = self.picture = picture(run.world, run.clock.frame, run.clock.time, self.scenery.number)
        self._drawn, self._drawn_at = (run.clock.frame, run.clock.step), time.perf_counter()
        return drawn
