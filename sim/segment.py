"""Simulate a range of frames of one specification: the stage that the workflow calls.

Exit status: 0 done, 2 refused, 3 stopped by the failure policy (see failure.json in the output
folder), 130 interrupted; the last good state is kept in the output folder.
"""

from __future__ import annotations

import argparse
import contextlib
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from common import signals
from common.arguments import frame_range, positive
from common.command import end_with
from common.files import Reserve, write_json
from common.signals import INTERRUPTED
from scene.settings import Refused
from scene.spec_option import HELP, read_spec
from sim.device import precision, runtime
from sim.device.compiler_choice import chosen
from sim.run.checkpoint import Checkpoint, state_name
from sim.run.failure import Fault, Interrupted, Stopped, report
from sim.run.output import Output
from sim.run.placing.extent import filmed
from sim.run.reporting.progress import Progress
from sim.run.reporting.shortfalls import Work, shortfalls
from sim.run.stepping import Run
from sim.spec import SimulationSpec

DONE, REFUSED, STOPPED = 0, 2, 3
ROOM = 1 << 16
"""Bytes for failure.json, summary.json and the head of a state."""


def simulate(
    spec: SimulationSpec,
    folder: Path,
    out: Path,
    *,
    first: int,
    last: int,
    state: Path | None = None,
    threads: int | None = None,
    arch: str = "auto",
    quiet: bool = False,
) -> int:
    """Simulate frames `first` to `last` into `out`; returns the exit status.

    Frame 0 is the initial state; any other first frame goes on from `state`, made after the frame
    before. Raises Refused before the first step.
    """
    if state is None and first > 0:
        raise Refused(
            f"frame {first} cannot be the first without the state after frame {first - 1}",
            remedy=f"give --resume {state_name(first - 1)}, or start at frame 0",
        )
    if threads is not None and threads < 1:
        raise Refused(f"{threads} threads cannot compute", remedy="give at least one, or leave --threads out")
    began = time.perf_counter()
    precision.choose(spec.precision)
    spec = spec.before(last / spec.fps)
    checkpoint = Checkpoint.load(state, spec) if state else None
    if checkpoint and checkpoint.clock.frame != first - 1:
        raise Refused(
            f"{state} is the state after frame {checkpoint.clock.frame}, and frame {first} was to come next",
            remedy=f"use --frames {checkpoint.clock.frame + 1}:{max(last, checkpoint.clock.frame + 1)}",
        )
    _prepare(out)
    progress = Progress(first, last, quiet=quiet)
    run = Run(spec, folder, threads=threads, arch=arch, warn=progress.say)
    run.resume(checkpoint) if checkpoint else run.start()
    with _stopping(run):
        return _carry_out(run, out, last, progress, began)


def _carry_out(run: Run, out: Path, last: int, progress: Progress, began: float) -> int:
    """Simulate up to frame `last`, and leave files that tell how it ended; returns the exit status."""
    start_time, going_on, before = run.clock.time, run.good is not None, replace(run.counts)
    reserve = Reserve(out)
    try:
        reserve.hold(run.checkpoint().bytes + ROOM)
        output = Output(out, run.spec, start_time if going_on else None)
    except OSError as error:
        reserve.release()
        raise _not_writable(out, error) from None

    def done() -> None:
        reserve.hold(run.last_good.bytes + ROOM)
        progress.update(run)

    status, failure = DONE, None
    try:
        run.frames(last, output, write_first=not going_on, done=done)
    except Stopped as stopped:
        status, failure = STOPPED, stopped.report
    except Interrupted:
        status = INTERRUPTED
    except OSError as error:
        fault = Fault(
            f"{error.filename or out}: {error.strerror or error}",
            f"make room or mend it, and go on with --resume {out / state_name(run.good.clock.frame)}"
            if run.good
            else "make room or mend it, and start again",
        )
        status, failure = STOPPED, report(run.world, run.clock, fault, run.good.clock if run.good else None, 0)
    finally:
        progress.close()
        output.close()
        reserve.release()
    for text in shortfalls(run.world.spec, before, run.counts, _work(run)):
        run.notices.tell(text)
    try:
        with signals.handled(signal.SIG_IGN):
            if failure:
                write_json(out / "failure.json", failure)
            if run.good:
                run.good.save(out / state_name(run.good.clock.frame), run.spec)
            write_json(out / "summary.json", _summary(run, status, start_time, time.perf_counter() - began))
    except OSError as error:
        print(f"stopped: {_not_writable(out, error)}", file=sys.stderr)
        status = STOPPED
    if failure:
        print(_explain(failure, out), file=sys.stderr)
    elif status == INTERRUPTED:
        kept = f"; state kept: {out / state_name(run.good.clock.frame)}" if run.good else ""
        print(f"interrupted at {run.clock.time:.6g} s{kept}", file=sys.stderr)
    return status


def _work(run: Run) -> Work:
    points = sum(len(item.fabric.points) for item in run.world.sheets)
    return Work(run.steps_taken, run.particle_steps, points * run.steps_taken)


def _prepare(out: Path) -> None:
    """Make the folder, and remove what an earlier run said about its end."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
        for name in ("failure.json", "summary.json"):
            (out / name).unlink(missing_ok=True)
    except OSError as error:
        raise _not_writable(out, error) from None


def _not_writable(out: Path, error: OSError) -> Refused:
    return Refused(
        f"{error.filename or out} cannot be written: {error.strerror or error}",
        remedy="make room, or give another --out",
    )


@contextlib.contextmanager
def _stopping(run: Run) -> Iterator[None]:
    """At a signal the run ends after the step; at a second one, or in the first step, which compiles, at once."""

    def ask(number: int, frame: object) -> None:
        if run.stop_requested:
            raise Interrupted
        run.stop_requested = True

    def before_step() -> None:
        if compiling and run.steps_taken < 2:
            signals.hand_over(ask if run.steps_taken else signal.SIG_DFL)

    compiling = signals.are_at_once()
    run.before_step = before_step
    with signals.handled(ask):
        yield


def _explain(failure: dict[str, Any], out: Path) -> str:
    frame, state = failure["last_good_frame"], failure["last_good_state"]
    kept = f"frames up to {frame} are good; state kept: {out / state}" if state else "no frame was written"
    return (
        f"stopped at {failure['time']:.6g} s (step {failure['step']}): {failure['detected']}\n"
        f"  {kept}\n"
        f"  fix: {failure['change']}\n"
        f"  more in {out / 'failure.json'}"
    )


def _summary(run: Run, status: int, start_time: float, wall: float) -> dict[str, Any]:
    """Contents of summary.json; times in seconds, lengths in metres."""
    modules = sorted(run.spec.materials())
    stepping = run.stopwatch.seconds.get("stepping", 0.0)
    repaired = {
        item.name: item.solid.report.lines() for item in run.world.obstacles.placed if item.solid.report is not None
    }
    return {
        "status": {DONE: "done", STOPPED: "stopped", INTERRUPTED: "interrupted"}[status],
        "versions": {name: version(name) for name in ("tidemill", chosen().package, "numpy") if _installed(name)},
        "device": run.device,
        "one_thread": run.one_thread and run.device == "cpu",
        "modules": modules,
        "kernels": runtime.compiled_kernels(),
        "chosen": run.world.choices(),
        "bytes": run.world.bytes_by_module(),
        "counts": vars(run.counts)
        | {
            "steps": run.steps_taken,
            "particles": run.world.fluid.count if run.world.fluid else 0,
            "boundary_samples": run.world.fluid.system.boundary.sampled if run.world.fluid else 0,
        },
        "repaired": repaired,
        "untangled": run.notices.untangled,
        "warnings": run.notices.warnings,
        "fps": run.spec.fps,
        "simulated_s": round((run.good.clock.time if run.good else start_time) - start_time, 9),
        "wall_s": run.stopwatch.rounded() | {"total": round(wall, 4)},
        "particle_steps_per_s": round(run.particle_steps / stepping) if stepping > 0 else 0,
    } | filmed(run.world)


def _installed(name: str) -> bool:
    from importlib.metadata import PackageNotFoundError

    try:
        version(name)
    except PackageNotFoundError:
        return False
    return True


def guarded(action: Callable[[], int]) -> int:
    """Run `action`, turning what can go wrong outside the physics into a message and an exit status."""

    try:
        # Before the first step there is nothing to save, and an exception may crash a library that is just loading.
        with signals.at_once():
            return action()
    except Refused as refused:
        print(f"refused: {refused}", file=sys.stderr)
        return REFUSED


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m sim.segment", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help=HELP)
    parser.add_argument("--folder", type=Path, required=True, help="folder that relative asset paths start from")
    parser.add_argument("--frames", type=frame_range, required=True, metavar="A:B", help="frames to write")
    parser.add_argument("--resume", type=Path, metavar="STATE", help="state after frame A-1")
    parser.add_argument("--out", type=Path, required=True, help="folder for frames, tables and the state after frame B")
    parser.add_argument("--threads", type=positive(int), help="CPU threads (default: all; small scenes take one)")
    parser.add_argument("--arch", choices=("auto", "cpu", "cuda"), default="auto", help="default: CUDA if there")
    options = parser.parse_args(arguments)
    return guarded(
        lambda: simulate(
            read_spec(SimulationSpec, options.spec),
            options.folder,
            options.out,
            first=options.frames.first,
            last=options.frames.last,
            state=options.resume,
            threads=options.threads,
            arch=options.arch,
        )
    )


if __name__ == "__main__":
    end_with(main, goes_on=True)
