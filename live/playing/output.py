"""What a run that is played writes to, in place of files."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from live.playing.picture import Course
    from sim.fluid.measure import Measure
    from sim.run.world import World


class PlayedOutput:
    """Called as `sim.run.output.Output` is; `stepped` is called with the time [s] of every step that is good."""

    probes = None

    def __init__(self, course: Course, stepped: Callable[[float], None]):
        self._course = course
        self._stepped = stepped

    def step(
        self,
        step: int,
        at: float,
        dt: float,
        wall: float,
        world: World,
        measure: Measure | None,
        told: dict[str, float],
    ) -> None:
        self._course.add(at, world, measure)
        self._stepped(at)

    def frame(self, frame: int, at: float, world: World) -> None:
        self._course.settle()

    def drop_rows(self) -> None:
        self._course.drop()
