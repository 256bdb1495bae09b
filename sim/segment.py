"""Simulate a range of frames of one specification: the stage that the workflow calls.

Exit status: 0 done, 2 refused, 3 stopped by the failure policy (see failure.json in the output
folder; the last good state is kept there).
"""

from __future__ import annotations

import argparse
import errno
import json
import signal
import sys
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

from sim.checkpoint import Checkpoint, state_name
from sim.failure import Stopped
from sim.files import write_json
from sim.output import Output
from sim.progress import Progress
from sim.settings import Refused
from sim.spec import SimulationSpec
from sim.stepping import Run

DONE, REFUSED, STOPPED, INTERRUPTED = 0, 2, 3, 130


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
            f"frame {first} can not be the first without the state after frame {first - 1}",
            remedy=f"give --resume {state_name(first - 1)}, or start at frame 0",
        )
    began = time.perf_counter()
    spec = spec.before(last / spec.fps)
    checkpoint = Checkpoint.load(state, spec) if state else None
    if checkpoint and checkpoint.clock.frame != first - 1:
        raise Refused(
            f"{state} is the state after frame {checkpoint.clock.frame}, and frame {first} was to come next",
            remedy=f"use --frames {checkpoint.clock.frame + 1}:{max(last, checkpoint.clock.frame + 1)}",
        )
    _make_folder(out)
    progress = Progress(first, last, quiet=quiet)
    run = Run(spec, folder, threads=threads, arch=arch, warn=progress.say)
    run.resume(checkpoint) if checkpoint else run.start()
    start_time = run.clock.time
    output = Output(out, spec)
    status, good, failure = DONE, checkpoint, None

    def interrupt(number: int, _: Any) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, interrupt)
    try:
        good = run.frames(last, output, write_first=checkpoint is None, done=lambda: progress.update(run))
    except Stopped as stopped:
        status, good, failure = STOPPED, stopped.good, stopped.report
        write_json(out / "failure.json", failure)
    except KeyboardInterrupt:
        progress.say("interrupted")
        return INTERRUPTED
    finally:
        progress.close()
        output.close()
    good.save(out / state_name(good.clock.frame), spec)
    write_json(out / "summary.json", _summary(run, status, good, start_time, time.perf_counter() - began))
    if failure:
        print(_explain(failure, out), file=sys.stderr)
    return status


def _make_folder(out: Path) -> None:
    try:
        out.mkdir(parents=True, exist_ok=True)
        probe = out / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise Refused(f"{out} can not be written to: {error.strerror}", remedy="give another --out") from None


def _explain(failure: dict[str, Any], out: Path) -> str:
    return (
        f"stopped at {failure['time']:.6g} s (step {failure['step']}): {failure['detected']}\n"
        f"  frames up to {failure['last_good_frame']} are good; state kept: {out / failure['last_good_state']}\n"
        f"  fix: {failure['change']}\n"
        f"  more in {out / 'failure.json'}"
    )


def _summary(run: Run, status: int, good: Checkpoint, start_time: float, wall: float) -> dict[str, Any]:
    """Contents of summary.json; times in seconds, lengths in metres."""
    modules = sorted(run.spec.materials())
    stepping = run.stopwatch.seconds.get("stepping", 0.0)
    repaired = {
        item.name: item.solid.report.lines() for item in run.world.obstacles.placed if item.solid.report is not None
    }
    return {
        "status": {DONE: "done", STOPPED: "stopped"}[status],
        "versions": {name: version(name) for name in ("tidemill", "taichi", "numpy") if _installed(name)},
        "device": run.device,
        "modules": modules,
        "bytes": run.world.bytes_by_module(),
        "counts": vars(run.counts)
        | {
            "steps": run.steps_taken,
            "particles": run.world.fluid.count if run.world.fluid else 0,
            "boundary_samples": run.world.fluid.system.boundary.count if run.world.fluid else 0,
        },
        "repaired": repaired,
        "simulated_s": round(good.clock.time - start_time, 9),
        "wall_s": run.stopwatch.rounded() | {"total": round(wall, 4)},
        "particle_steps_per_s": round(run.particle_steps / stepping) if stepping > 0 else 0,
        "extent": {"min": run.world.bounds[0].tolist(), "max": run.world.bounds[1].tolist()},
    }


def _installed(name: str) -> bool:
    from importlib.metadata import PackageNotFoundError

    try:
        version(name)
    except PackageNotFoundError:
        return False
    return True


def guarded(action) -> int:
    """Run `action`, turning what can go wrong outside the physics into a message and an exit status."""
    try:
        return action()
    except Refused as refused:
        print(f"refused: {refused}", file=sys.stderr)
        return REFUSED
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EACCES, errno.EFBIG):
            raise
        print(f"stopped: {error.filename or 'output'}: {error.strerror}\n  fix: make room and go on from the last state")
        return STOPPED


def frame_range(text: str) -> tuple[int, int]:
    """`A:B`, both included."""
    first, colon, last = text.partition(":")
    if not colon or not first.isdigit() or not last.isdigit() or int(last) < int(first):
        raise argparse.ArgumentTypeError(f"expected FIRST:LAST as in 0:24, got '{text}'")
    return int(first), int(last)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m sim.segment", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, help="settings of the simulation as JSON, or @FILE that holds them")
    parser.add_argument("--folder", type=Path, required=True, help="folder that relative asset paths start from")
    parser.add_argument("--frames", type=frame_range, required=True, metavar="A:B", help="frames to write, both included")
    parser.add_argument("--resume", type=Path, metavar="STATE", help="state after frame A-1")
    parser.add_argument("--out", type=Path, required=True, help="folder for frames, tables and the state after frame B")
    parser.add_argument("--threads", type=int, help="CPU threads (default: all)")
    parser.add_argument("--arch", choices=("auto", "cpu", "cuda"), default="auto", help="device (default: CUDA if there)")
    options = parser.parse_args(arguments)
    text = Path(options.spec[1:]).read_text() if options.spec.startswith("@") else options.spec
    first, last = options.frames
    return guarded(
        lambda: simulate(
            SimulationSpec.model_validate(json.loads(text)),
            options.folder,
            options.out,
            first=first,
            last=last,
            state=options.resume,
            threads=options.threads,
            arch=options.arch,
        )
    )


if __name__ == "__main__":
    sys.exit(main())
