"""A simulation that others steer: it plays, pauses, goes back, and takes in changes between its steps."""

from __future__ import annotations

import os
import queue
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from live.history import History
from live.picture import Course, Picture, Scenery, picture, scenery
from live.script import Script
from scene.document import SceneError
from scene.events import TIME_TOLERANCE, apply
from scene.settings import Refused
from sim.device import precision
from sim.run.failure import Interrupted, Stopped
from sim.run.stepping import Run

if TYPE_CHECKING:
    import numpy as np

    from scene.load import Scene
    from sim.fluid.measure import Measure
    from sim.run.checkpoint import Checkpoint, Clock
    from sim.run.world import World
    from sim.spec import Event, SimulationSpec

NICE = 8
"""Priority of the simulation among processes."""
MOST_WAITING = 200
"""Actions that may wait for the next step."""
LAST_FRAME = 1_000_000
PICTURES = 1 / 25
"""Shortest time between two pictures [s]."""
HISTORY = 1 << 30
"""Bytes of states to go back to."""

Answer = Callable[[str], None]
"""Told what was wrong; not called where nothing was."""
Change = dict[str, Any] | Callable[[float], dict[str, Any]]
"""An event as a scene file describes it, without its time; or what makes one of its time [s]."""


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


class _Again(Exception):
    """The frame is simulated anew from its start."""


class Session:
    """Plays a scene in the thread that calls `run`; everything else may be called from any thread.

    Actions wait in a queue, and are carried out between two steps.
    """

    def __init__(self, scene: Scene, *, threads: int | None = None, arch: str = "auto", history: int = HISTORY):
        self.script = Script(scene)
        self.status = Status()
        self.picture: Picture | None = None
        self.scenery = Scenery()
        self.course = Course()
        self.history = History(history)
        self.speed: float | None = None
        """Simulated over wall-clock time at most; without it, as fast as it goes."""
        self.watched = False
        """Whether anybody looks at pictures."""
        self.said: deque[str] = deque(maxlen=100)
        self._output: Any = _Output(self)
        """Called as `sim.run.output.Output` is."""
        self._actions: queue.Queue[Callable[[], None]] = queue.Queue(MOST_WAITING)
        self._paused, self._single, self._closed = True, False, False
        self._played: list[Event] = []
        self._refusals: dict[int, Answer] = {}
        self._seen: World | None = None
        self._applied_until = -1.0
        """Events up to this time [s] have happened."""
        self._let_pass = False
        self._drawn, self._drawn_at = (-1, -1), 0.0
        self._paced_from = (0.0, 0.0)
        self._recent: deque[tuple[float, float]] = deque(maxlen=30)
        self._threads, self._arch = threads, arch
        self._run: Run | None = None
        self.ready = threading.Event()

    # What others call

    def play(self) -> None:
        """Go on from here."""
        self._wait_for(self._play)

    def pause(self) -> None:
        """Stop before the next step."""
        self._wait_for(lambda: self._pause())

    def step(self) -> None:
        """Simulate to the end of the frame, then pause."""
        self._wait_for(self._step)

    def go_back(self, frame: int) -> None:
        """To the last state kept at or before a frame; what was done since is forgotten."""
        self._wait_for(lambda: self._go_back(frame))

    def set_speed(self, factor: float | None) -> None:
        """Simulated over wall-clock time at most; none: as fast as it goes."""
        self._wait_for(lambda: self._set_speed(factor))

    def change(self, data: Change, refused: Answer) -> None:
        """Let an event happen as soon as it can."""
        self._wait_for(lambda: self._change(data, refused), refused)

    def save(self, path: Path, saved: Callable[[Scene], None], refused: Answer) -> None:
        """Write a scene file whose film shows the frames until now."""
        self._wait_for(lambda: self._save(path, saved, refused), refused)

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
    def waiting(self) -> int:
        """How many changes happen with the next steps."""
        return sum(event.at > self._applied_until + TIME_TOLERANCE for event in tuple(self._played))

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
        if self._simulation.world is not self._seen:
            self._applied_until = self._simulation.clock.time
            self._look_around()
        while True:
            try:
                while not self._closed:
                    self._actions.get_nowait()()
            except queue.Empty:
                pass
            if self._closed:
                raise Interrupted
            if not self._paused or self._let_pass:
                self._let_pass = False
                break
            self._draw()
            try:
                self._actions.get(timeout=0.1)()
            except queue.Empty:
                continue
        self._keep_pace()

    def _keep_pace(self) -> None:
        if self.speed is None or self._paused:
            return
        wall, simulated = self._paced_from
        ahead = (self._simulation.clock.time - simulated) / self.speed - (time.perf_counter() - wall)
        if ahead > 0:
            time.sleep(min(ahead, 0.1))

    # Actions

    def _wait_for(self, action: Callable[[], None], refused: Answer | None = None) -> None:
        try:
            self._actions.put_nowait(action)
        except queue.Full:
            if refused:
                refused("too many actions wait for the simulation: wait for it")

    def _play(self) -> None:
        self._paused, self._single = False, False
        self._start_pace()
        self.status = replace(self.status, mode="playing", problem="")

    def _pause(self, problem: str = "") -> None:
        self._paused, self._single = True, False
        self._draw()
        self.status = replace(self.status, mode="paused", problem=problem or self.status.problem, factor=0.0)

    def _step(self) -> None:
        self._play()
        self._single = True

    def _set_speed(self, factor: float | None) -> None:
        self.speed = factor
        self._start_pace()

    def _start_pace(self) -> None:
        self._paced_from = (time.perf_counter(), self._simulation.clock.time)
        self._recent.clear()

    def _go_back(self, frame: int) -> None:
        state = self.history.back_to(frame)
        run = self._simulation
        gone = {id(event) for event in self._played if event.at > state.clock.time - TIME_TOLERANCE}
        self._forget(gone)
        self.course.back_to(state.clock.time)
        run.good = state
        self._pause()
        self.status = replace(self.status, problem="")
        raise _Again

    def _forget(self, gone: set[int]) -> None:
        run = self._simulation
        self._played = [event for event in self._played if id(event) not in gone]
        kept = tuple(event for event in run.spec.events if id(event) not in gone)
        run.spec = run.spec.model_copy(update={"events": kept})

    def _change(self, data: Change, refused: Answer) -> None:
        run = self._simulation
        applied = run.untouched and self._applied_until > run.clock.time - TIME_TOLERANCE
        redone = applied and self._paused
        at = run.clock.frame / run.spec.fps if redone else run.earliest()
        try:
            event = self.script.event(at, data(at) if callable(data) else data, self._upcoming(), run.spec.body_names())
        except SceneError as error:
            refused(str(error))
            return
        run.bring_in(event)
        self._played.append(event)
        self._refusals[id(event)] = refused
        self._let_pass = run.untouched
        if redone:
            raise _Again

    def _upcoming(self) -> SimulationSpec:
        """The settings in force once everything has happened that is on its way."""
        spec = self.spec
        for index, event in enumerate(self._played):
            if event.at > self._applied_until + TIME_TOLERANCE:
                spec = apply(spec, event, index)
        return spec

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
        self.course.drop()
        self._applied_until = run.clock.time - 2 * TIME_TOLERANCE
        self._let_pass = self._happens_now
        self._look_around()
        self._start_pace()

    def _stopped(self, stopped: Stopped) -> None:
        """Go back to the last good state: without the change that was refused, or to pause and say why."""
        run = self._simulation
        refused = stopped.__cause__ if isinstance(stopped.__cause__, Refused) else None
        now = [event for event in self._played if abs(event.at - run.clock.time) < TIME_TOLERANCE]
        if refused is not None and now:
            self._refusals.pop(id(now[-1]), lambda text: None)(str(refused))
            self._forget({id(now[-1])})
        else:
            report = stopped.report
            self._pause(f"stopped at {report['time']:.6g} s: {report['detected']}\nfix: {report['change']}")
        self._resume()

    def _frame_done(self) -> None:
        self.history.keep(self._last_good)
        self._refusals.clear()
        if self._single:
            self._pause()
            self._let_pass = self._happens_now

    @property
    def _happens_now(self) -> bool:
        run = self._simulation
        return any(abs(event.at - run.clock.time) < TIME_TOLERANCE for event in run.spec.events)

    def _look_around(self) -> None:
        self._seen = self._simulation.world
        self.scenery = scenery(self._seen, self.scenery.number + 1)
        self._drawn = (-1, -1)

    def _draw(self) -> None:
        """Make a picture, unless it would be the one there is."""
        run = self._simulation
        if self._drawn == (run.clock.frame, run.clock.step):
            return
        self.picture = picture(run.world, run.clock.frame, run.clock.time, self.scenery.number)
        self._drawn, self._drawn_at = (run.clock.frame, run.clock.step), time.perf_counter()
        rate, factor = self._rates()
        frames = self.history.frames or [0]
        self.status = replace(
            self.status,
            frame=run.clock.frame,
            time=run.clock.time,
            particles=len(self.picture.points),
            factor=factor,
            steps_per_second=rate,
            kept=(frames[0], frames[-1]),
        )

    def _rates(self) -> tuple[float, float]:
        """Steps per second, and simulated over wall-clock time, of the last steps."""
        if len(self._recent) < 2:
            return 0.0, 0.0
        (began, simulated), (now, until) = self._recent[0], self._recent[-1]
        wall = max(now - began, 1e-9)
        return (len(self._recent) - 1) / wall, (until - simulated) / wall

    def step_written(self, at: float, world: World, measure: Measure | None) -> None:
        """A step was taken."""
        now = time.perf_counter()
        self.course.add(at, world, measure)
        self._recent.append((now, at))
        if self.watched and now - self._drawn_at >= PICTURES:
            self._draw()


def _yield_to_others() -> None:
    """Let the page and a browser on this machine go first: this thread and those that it starts can wait."""
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICE)


class _Output:
    """What a run writes to, in place of files."""

    probes = None

    def __init__(self, session: Session):
        self._session = session

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
        self._session.step_written(at, world, measure)

    def frame(self, frame: int, at: float, world: World) -> None:
        self._session.course.settle()

    def drop_rows(self) -> None:
        self._session.course.drop()
