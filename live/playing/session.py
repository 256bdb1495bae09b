"""A simulation that others steer: it plays, pauses, goes back, and takes in changes between its steps."""

from __future__ import annotations

import os
import sys
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from live.playing.actions import WaitingActions
from live.playing.display import Display
from live.playing.history import History
from live.playing.output import PlayedOutput
from live.playing.pace import Pace
from live.playing.played import Answer, PlayedEvents
from live.playing.script import Script
from live.playing.status import Status
from scene.document import SceneError
from scene.events import TIME_TOLERANCE
from scene.settings import Refused
from sim.device import precision
from sim.run.failure import Interrupted, Stopped
from sim.run.stepping import Run

if TYPE_CHECKING:
    import numpy as np

    from scene.load import Scene
    from sim.run.checkpoint import Checkpoint, Clock
    from sim.spec import SimulationSpec

NICE = 8
"""Priority of the simulation among processes."""
LAST_FRAME = 1_000_000
LOOK = 0.1
"""How long to wait for an action while paused, before looking whether to close [s]."""
HISTORY = 1 << 30
"""Bytes of states to go back to."""

Change = dict[str, Any] | Callable[[float], dict[str, Any]]
"""An event as a scene file describes it, without its time; or what makes one of its time [s]."""


class _Again(Exception):
    """The frame is simulated anew from its start."""


class Session:
    """Plays a scene in the thread that calls `run`; everything else may be called from any thread.

    Actions wait in a queue, and are carried out between two steps.
    """

    def __init__(self, scene: Scene, *, threads: int | None = None, arch: str = "auto", history: int = HISTORY):
        self.script = Script(scene)
        self.status = Status()
        self.display = Display()
        self.history = History(history)
        self.pace = Pace()
        self.said: deque[str] = deque(maxlen=100)
        self._output: Any = PlayedOutput(self.display.course, self._stepped)
        self._actions = WaitingActions()
        self._paused, self._single, self._closed = True, False, False
        self.played = PlayedEvents()
        self._let_pass = False
        self._threads, self._arch = threads, arch
        self._run: Run | None = None
        self.ready = threading.Event()

    # What others call

    def play(self) -> None:
        """Go on from here."""
        self._actions.add(self._play)

    def pause(self) -> None:
        """Stop before the next step."""
        self._actions.add(lambda: self._pause())

    def step(self) -> None:
        """Simulate to the end of the frame, then pause."""
        self._actions.add(self._step)

    def go_back(self, frame: int) -> None:
        """To the last state kept at or before a frame; what was done since is forgotten."""
        self._actions.add(lambda: self._go_back(frame))

    def set_speed(self, factor: float | None) -> None:
        """Simulated over wall-clock time at most; none: as fast as it goes."""
        self._actions.add(lambda: self.pace.limit(factor, self._simulation.clock.time))

    def change(self, data: Change, refused: Answer) -> None:
        """Let an event happen as soon as it can."""
        self._actions.add(lambda: self._change(data, refused), refused)

    def save(self, path: Path, saved: Callable[[Scene], None], refused: Answer) -> None:
        """Write a scene file whose film shows the frames until now."""
        self._actions.add(lambda: self._save(path, saved, refused), refused)

    def close(self) -> None:
        """Let `run` return before the next step."""
        self._closed = True

    @property
    def spec(self) -> SimulationSpec:
        """The settings in force, without events."""
        return self._simulation.world.spec

    @property
    def clock(self) -> Clock:
        """Of the run."""
        return self._simulation.clock

    @property
    def bounds(self) -> np.ndarray:
        """Box around all that happens [m], shape [2, 3]."""
        return self._simulation.world.bounds

    @property
    def _simulation(self) -> Run:
        if self._run is None:
            raise RuntimeError("the simulation has not been built yet")
        return self._run

    @property
    def _last_good(self) -> Checkpoint:
        """The state after the last frame, or of the start."""
        good = self._simulation.good
        if good is None:
            raise RuntimeError("the simulation has not begun yet")
        return good

    # The thread of the simulation

    def run(self) -> None:
        """Simulate until closed; raises Refused where the scene cannot be built."""
        _yield_to_others()
        scene = self.script.scene
        precision.choose(scene.simulation.precision)
        self._run = run = Run(
            scene.simulation, scene.folder, threads=self._threads, arch=self._arch, warn=self.said.append
        )
        run.start()
        run.before_step = self._before_step
        self._look_around()
        self._draw()
        self.status = replace(self.status, mode="paused")
        self.ready.set()
        first = True
        while not self._closed:
            try:
                run.frames(LAST_FRAME, self._output, write_first=first, done=self._frame_done)
            except _Again:
                self._resume()
            except Stopped as stopped:
                self._stopped(stopped)
            except Interrupted:
                break
            first = False
        self.status = replace(self.status, mode="closed")

    def _before_step(self) -> None:
        """Carry out what waits; wait while paused."""
        if self._simulation.world is not self.display.seen:
            self.played.applied_until = self._simulation.clock.time
            self._look_around()
        while True:
            while not self._closed and self._actions.carry_out_next():
                pass
            if self._closed:
                raise Interrupted
            if not self._paused or self._let_pass:
                self._let_pass = False
                break
            self._draw()
            self._actions.carry_out_next(wait=LOOK)
        if not self._paused:
            self.pace.keep(self._simulation.clock.time)

    # Actions

    def _play(self) -> None:
        self._paused, self._single = False, False
        self.pace.start(self._simulation.clock.time)
        self.status = replace(self.status, mode="playing", problem="")

    def _pause(self, problem: str = "") -> None:
        self._paused, self._single = True, False
        self._draw()
        self.status = replace(self.status, mode="paused", problem=problem or self.status.problem, factor=0.0)

    def _step(self) -> None:
        self._play()
        self._single = True

    def _go_back(self, frame: int) -> None:
        state = self.history.back_to(frame)
        run = self._simulation
        self.played.forget_from(state.clock.time, run)
        self.display.course.back_to(state.clock.time)
        run.good = state
        self._pause()
        self.status = replace(self.status, problem="")
        raise _Again

    def _change(self, data: Change, refused: Answer) -> None:
        run = self._simulation
        applied = run.untouched and self.played.applied_until > run.clock.time - TIME_TOLERANCE
        redone = applied and self._paused
        at = run.clock.frame / run.spec.fps if redone else run.earliest()
        try:
            upcoming = self.played.upcoming(self.spec)
            event = self.script.event(at, data(at) if callable(data) else data, upcoming, run.spec.body_names())
        except SceneError as error:
            refused(str(error))
            return
        self.played.bring_in(event, run, refused)
        self._let_pass = run.untouched
        if redone:
            raise _Again

    def _save(self, path: Path, saved: Callable[[Scene], None], refused: Answer) -> None:
        frames = self._simulation.clock.frame
        if frames == 0:
            refused("there is nothing to save yet: play at least one frame")
            return
        try:
            saved(self.script.save(path, self._simulation.spec.events, frames))
        except SceneError as error:
            refused(str(error))
        except OSError as error:
            refused(f"{path} cannot be written: {error.strerror or error}")

    # What became of frames

    def _resume(self) -> None:
        run = self._simulation
        run.resume(self._last_good)
        self.display.course.drop()
        self.played.applied_until = run.clock.time - 2 * TIME_TOLERANCE
        self._let_pass = self._happens_now
        self._look_around()
        self.pace.start(run.clock.time)

    def _stopped(self, stopped: Stopped) -> None:
        """Go back to the last good state: without the change that was refused, or to pause and say why."""
        refused = stopped.__cause__ if isinstance(stopped.__cause__, Refused) else None
        if refused is None or not self.played.refuse(str(refused), self._simulation):
            report = stopped.report
            self._pause(f"stopped at {report['time']:.6g} s: {report['detected']}\nfix: {report['change']}")
        self._resume()

    def _frame_done(self) -> None:
        self.history.keep(self._last_good)
        self.played.accept()
        if self._single:
            self._pause()
            self._let_pass = self._happens_now

    @property
    def _happens_now(self) -> bool:
        run = self._simulation
        return any(abs(event.at - run.clock.time) < TIME_TOLERANCE for event in run.spec.events)

    def _look_around(self) -> None:
        self.display.look_around(self._simulation.world)

    def _draw(self) -> None:
        """Make a picture, unless it would be the one there is, and say how things stand."""
        run = self._simulation
        drawn = self.display.draw(run)
        if drawn is None:
            return
        rate, factor = self.pace.rates()
        frames = self.history.frames or [0]
        self.status = replace(
            self.status,
            frame=run.clock.frame,
            time=run.clock.time,
            particles=len(drawn.points),
            factor=factor,
            steps_per_second=rate,
            kept=(frames[0], frames[-1]),
        )

    def _stepped(self, at: float) -> None:
        self.pace.step(at)
        if self.display.due:
            self._draw()


def _yield_to_others() -> None:
    """Let the page and a browser on this machine go first: this thread and those that it starts can wait."""
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICE)
