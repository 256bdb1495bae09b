"""From frame to frame: time steps, events, retries, checkpoints."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from common.stopwatch import Stopwatch
from scene.events import TIME_TOLERANCE, apply, events_between, spec_before
from scene.settings import Refused, given
from sim.device import compilation, runtime
from sim.run.checkpoint import Checkpoint, Clock
from sim.run.failure import MAX_RETRIES, Fault, Interrupted, Stopped, find_fault, report, short_step
from sim.run.first_step import refuse_beginning
from sim.run.one_thread import takes_one_thread
from sim.run.output import Output
from sim.run.placing.fluid_bodies import numbered, without
from sim.run.probes.sampling import Probes
from sim.run.reporting.counts import Counts
from sim.run.reporting.notices import Notices
from sim.run.time_steps import EventWindow, fit, landing, wanted_step
from sim.run.world import World
from sim.spec import Event, SimulationSpec

if TYPE_CHECKING:
    from sim.fluid.births import Births
    from sim.fluid.measure import Measure
    from sim.fluid.model import FluidState

RECOVERY = 2.0
"""After a frame without a fault, a shortened step may be this much longer in the next frame."""


class Run:
    """A simulation, frame by frame; `spec` holds the events up to its end.

    Raises Refused for a scene that cannot be built.
    """

    def __init__(
        self,
        spec: SimulationSpec,
        folder: Path,
        *,
        threads: int | None = None,
        arch: str = "auto",
        warn: Callable[[str], None] = print,
    ):
        self.spec = spec
        self.folder = folder
        self.threads = threads
        self.arch = arch
        self.notices = Notices(warn)
        self.device = "none"
        self.one_thread = False
        """Whether the scene is so small that it takes a single thread."""
        self.clock = Clock()
        self.counts = Counts()
        self.births: Births | None = None
        self.probes = Probes(spec)
        self.stopwatch = Stopwatch(compile=compilation.seconds)
        self.measure: Measure | None = None
        self.good: Checkpoint | None = None
        """The state after the last frame that was written."""
        self.stop_requested = False
        """Set from outside to end the run between two steps."""
        self.before_step: Callable[[], None] = lambda: None
        """Called before every step; may end the run by an exception, or bring in an event."""
        self._window = EventWindow()
        self.steps_taken = 0
        self.particle_steps = 0
        with self.stopwatch.phase("build"):
            self.world = World(spec_before(spec, 0.0), folder)

    def start(self) -> None:
        """Make the particles of the start."""
        state = None
        if self.spec.fluid is not None:
            from sim.fluid.births import Births
            from sim.fluid.model import FluidState

            self.births = Births()
            self.world.untangle(0.0)
            with self.stopwatch.phase("build"):
                state = self._pour(FluidState(), list(self.spec.fluid.bodies))
        self._build(state, {}, going_on=False)

    def resume(self, checkpoint: Checkpoint) -> None:
        """Go on from a checkpoint, byte for byte as the run that made it."""
        self.good = checkpoint
        self.one_thread = checkpoint.one_thread
        self.clock = Clock(**asdict(checkpoint.clock))
        self.counts = Counts(**checkpoint.counts)
        self.births = replace(checkpoint.births) if checkpoint.births else None
        self.probes = Probes(self.spec, checkpoint.probe_times, checkpoint.probe_means)
        with self.stopwatch.phase("build"):
            self.world = World(
                spec_before(self.spec, self.clock.time),
                self.folder,
                checkpoint.origin,
                checkpoint.rigid,
                checkpoint.cloth,
            )
        self._build(checkpoint.fluid, checkpoint.emission, going_on=True)

    @property
    def untouched(self) -> bool:
        """Whether no step of the frame was taken yet."""
        return self.clock.time < self.clock.frame / self.spec.fps + TIME_TOLERANCE

    def earliest(self) -> float:
        """The earliest time [s] at which an event can come in without a change of the steps taken until now, so that a
        run that knows of it from the start takes the same ones: at most two steps from now, or the end of the frame.

        Between two steps only.
        """
        end = (self.clock.frame + 1) / self.spec.fps
        known = [event.at for event in self.spec.events if self.clock.time + TIME_TOLERANCE < event.at < end]
        return self._window.earliest(known, end, self._last_step)

    def bring_in(self, event: Event) -> None:
        """Add an event, which is not to happen before `earliest`."""
        events = sorted([*self.spec.events, event], key=lambda event: event.at)
        self.spec = self.spec.model_copy(update={"events": tuple(events)})

    @property
    def last_good(self) -> Checkpoint:
        """The state after the last frame that was written; raises LookupError before the first."""
        if self.good is None:
            raise LookupError("no frame was written yet")
        return self.good

    @property
    def _last_step(self) -> float:
        return self.clock.last_step * self.clock.step_scale

    def checkpoint(self) -> Checkpoint:
        """The state between two steps."""
        return Checkpoint(
            clock=Clock(**asdict(self.clock)),
            counts=asdict(self.counts),
            probe_times=dict(self.probes.due),
            probe_means={name: replace(values) for name, values in self.probes.gathered.items()},
            emission=self._emission(),
            origin=self.world.origin,
            fluid=self.world.fluid.state() if self.world.fluid else None,
            births=replace(self.births) if self.births else None,
            rigid=self.world.rigid.state() if self.world.rigid else None,
            cloth=self.world.cloth.state() if self.world.cloth else None,
            one_thread=self.one_thread,
        )

    def frames(self, last: int, output: Output, *, write_first: bool, done: Callable[[], None]) -> None:
        """Simulate up to frame `last`, write every frame, call `done` after each.

        `write_first`: write the present frame too. Raises Stopped where a frame fails in spite of
        retries, and Interrupted; all frames written until then are good, and `good` is the state after them.
        """
        if write_first:
            self._sample(output)
            self._write(output)
            done()
        while self.clock.frame < last:
            try:
                self._frame(self.last_good, output)
            except Refused as refused:
                output.drop_rows()
                fault = Fault(str(refused.args[0]), refused.remedy or "change the event")
                raise Stopped(report(self.world, self.clock, fault, self.last_good.clock, 0)) from refused
            self._write(output)
            done()

    def _frame(self, good: Checkpoint, output: Output) -> None:
        """Simulate one frame, again with half the step where a fault is found."""
        taken, cause = self.steps_taken, None
        for retry in range(MAX_RETRIES + 1):
            fault = self._try_frame(output, retry)
            if fault is None:
                if retry == 0:
                    self.clock.step_scale = min(1.0, good.clock.step_scale * RECOVERY)
                return
            output.drop_rows()
            repeated = self.counts.steps_repeated + self.steps_taken - taken
            self.steps_taken = taken
            cause = fault if fault.repeatable or cause is None else cause
            if retry == MAX_RETRIES or not fault.repeatable:
                self.counts.steps_repeated = repeated
                raise Stopped(report(self.world, self.clock, cause, good.clock, retry))
            retries = self.counts.retries + 1
            self.resume(good)
            self.counts.retries, self.counts.steps_repeated = retries, repeated
            self.clock.step_scale = good.clock.step_scale * 0.5 ** (retry + 1)
            self.notices.warn(
                f"frame {self.clock.frame + 1}: {fault.what}; again with {self.clock.step_scale:g} of the step"
            )
        raise AssertionError("unreachable")

    def _try_frame(self, output: Output, retry: int) -> Fault | None:
        """Simulate one frame; what happens at the time of a frame is first seen in the frame after."""
        fallen = self.world.begin_frame()
        if fallen and not self.counts.particles_fallen:
            self.notices.tell_fallen(self.world.depth)
        self.counts.particles_fallen += fallen
        since, end = self.clock.time, (self.clock.frame + 1) / self.spec.fps
        self._window.begin_frame(since, repeated=retry > 0)
        while True:
            self.before_step()
            upcoming = events_between(self.spec, since, end)
            until = upcoming[0][0] if upcoming else end
            if self.clock.time < until - TIME_TOLERANCE:
                fault = self._step(until, output)
                if fault is not None:
                    return fault
            elif upcoming:
                self._apply_events(upcoming[0][1])
                since = until + 2 * TIME_TOLERANCE
                self._window.meet(until, self._last_step)
            else:
                self.clock.frame += 1
                return None

    def _step(self, until: float, output: Output) -> Fault | None:
        """One step, no further than to the time `until` [s], which is met exactly."""
        if self.stop_requested:
            output.drop_rows()
            raise Interrupted
        limit = self.world.step_limit(self.measure)
        fault = short_step(self.world, self.measure, limit * self.clock.step_scale, self.spec.fps)
        if fault is not None:
            return fault
        start = time.perf_counter()
        target = landing(until, self.world.next_keyframe(self.clock.time))
        rest = target - self.clock.time
        wanted = wanted_step(self.world.spec.step, limit, self.clock.last_step)
        even, longest = self.world.spec.step.fixed is None, wanted * self.clock.step_scale
        dt = fit(longest, rest, even=even)
        self._window.step(self.clock.time, longest, even=even)
        after = target if dt == rest else self.clock.time + dt
        with self.stopwatch.phase("stepping"):
            stats = self.world.advance(dt, after)
            self.measure = self.world.measure()
        self.clock.time = after
        self.clock.last_step = wanted
        self.clock.step += 1
        wall = time.perf_counter() - start
        fault = find_fault(self.world, self.measure, dt)
        if fault is not None:
            return fault
        self.steps_taken += 1
        self.particle_steps += self.world.fluid.count if self.world.fluid else 0
        self.counts.add_step(stats)
        output.step(self.clock.step, self.clock.time, dt, wall, self.world, self.measure, stats)
        self._sample(output)
        return None

    def _apply_events(self, events: list[Event]) -> None:
        """Build the world anew as events that happen now want it, with the particles there are."""
        spec = self.world.spec
        for event in events:
            spec = apply(spec, event, self.spec.events.index(event))
        state = self.world.fluid.state() if self.world.fluid else None
        emission, names = self._emission(), numbered(self.spec)
        self.world.release(spec)
        # Contacts are numbered by the bodies there are, which may change.
        rigid = self.world.rigid.state().without_contacts() if self.world.rigid else None
        cloth = self.world.cloth.state().without_contacts() if self.world.cloth else None
        with self.stopwatch.phase("build"):
            self.world = World(spec, self.folder, self.world.origin, rigid, cloth)
            for event in events if state is not None else ():
                state = self._pour(without(given(state), event.remove, names, self.counts), list(event.add.fluid))
        self._build(state, emission, going_on=False)

    def _emission(self) -> dict[str, Any]:
        """What emitters have sent."""
        return self.world.flow.ledger.state() if self.world.flow else self.world.emission

    def _pour(self, state: FluidState, bodies: list[str]) -> FluidState:
        if not bodies:
            return state
        before, names = state.count, numbered(self.spec)
        state = self.world.pour(state, names, bodies, self.counts, self.clock.time)
        given(self.births).add_bodies(state.tag[before:], names, self.clock.time)
        for text in self.world.warnings():
            self.notices.tell(text)
        return state

    def _build(self, state: FluidState | None, emission: dict[str, Any], *, going_on: bool) -> None:
        self.notices.tell_mended(self.world.obstacles)
        if not going_on:
            self.one_thread = takes_one_thread(self.world, state.count if state is not None else 0)
        if state is not None or self.world.obstacles.dynamic or self.world.sheets:
            with self.stopwatch.phase("compile"):
                self.device = runtime.start(threads=self.threads, arch=self.arch, serial=self.one_thread)
        with self.stopwatch.phase("build"):
            self.world.build(
                state,
                emission,
                self.counts,
                self.notices.tell,
                self.clock.time,
                births=self.births,
                going_on=going_on,
            )
            self.measure = self.world.measure()
        if not going_on:
            if self.world.rigid:
                self.notices.tell_overlaps(self.world.rigid)
            self.notices.tell_untangled(self.world.untangled or [])
        refuse_beginning(self.world, self.measure, self.spec.fps)

    def _sample(self, output: Output) -> None:
        if output.probes is not None:
            with self.stopwatch.phase("probes"):
                for row in self.probes.sample(self.world, self.clock.time):
                    output.probes.add(*row)

    def _write(self, output: Output) -> None:
        with self.stopwatch.phase("output"):
            output.frame(self.clock.frame, self.clock.time, self.world)
            self.good = self.checkpoint()
