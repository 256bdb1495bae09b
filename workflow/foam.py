"""Fluid makes foam: folders of fluid_00042.ply become a folder of foam_00042.ply.

example: foam of the first second of a simulation with particles of 1 cm radius
  python -m workflow.foam --spec '{"particle_radius": 0.01, "support_radius": 0.04, "fps": 24}' \\
      --simulation run/simulation --frames 0:24 --out run/foam

--spec takes JSON, the name of a file with it, or - for standard input: particle_radius [m] and support_radius [m] of
the fluid, fps, gravity, walls, and `foam`, the section of that name of a scene. Rigid bodies are read from the folders
of the simulation. Frame 0 has no foam; frames that begin later go on from --resume, the folder with the foam of the
frame before. The points carry velocities (vx vy vz), radius, life (what is left [s]) and kind (0 spray, 1 foam, 2
bubble).

exit codes: 0 done, 1 failed, 2 refused (settings or files cannot be used as they are)
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from common.arguments import frame_range, positive
from common.command import end_with
from common.files import write_json
from common.frames import Frames
from common.signals import at_once
from common.stopwatch import Stopwatch
from render.progress import Progress
from scene.settings import Refused
from scene.spec_option import HELP, read_spec
from sim.device.compiler_choice import chosen
from sim.foam.spec import FoamJobSpec
from workflow.stages import stage
from workflow.stages.bodies import Bodies
from workflow.stages.stage import exit_code

KINDS = ("spray", "foam", "bubbles")
MOVING = ("x", "y", "z", "vx", "vy", "vz")
"""What points say of where they are and go."""


def run(
    spec: FoamJobSpec,
    simulation: Sequence[Path],
    frames: Frames,
    out: Path,
    *,
    resume: Path | None = None,
    threads: int = 1,
    arch: str = "auto",
) -> None:
    """Write foam_*.ply and summary.json to `out`; raises Refused for particles that cannot be used."""
    watch = Stopwatch()
    if frames.first > 0 and resume is None:
        remedy = "give --resume, or start at frame 0"
        raise Refused(f"frame {frames.first} needs the foam of frame {frames.first - 1}", remedy=remedy)
    with watch.phase("import"):
        import numpy as np

        from sim.device import runtime

        device = runtime.start(threads=threads, arch=arch)

        from common.ply import write_points
        from sim.foam.particles import FOAM_POINT, next_frame
        from workflow.stages.points import read
    needed = range(frames.first - 1, frames.last + 1)
    with watch.phase("load"):
        stage.refuse_spoiled(simulation, "fluid_", "body", "bodies", frames=needed)
        stage.refuse_spoiled([resume] if resume else [], "foam_", frames=needed)
    out.mkdir(parents=True, exist_ok=True)
    bodies = Bodies(simulation)
    points, before = np.empty(0, FOAM_POINT), None
    if frames.first > 0:
        points = read([resume] if resume else [], f"foam_{frames.first - 1:05d}.ply", MOVING, FOAM_POINT.names or ())
        before = read(simulation, f"fluid_{frames.first - 1:05d}.ply", MOVING, ("id",))
    rows: list[dict[str, Any]] = []
    warnings: list[str] = []
    with Progress(len(frames)) as progress:
        for frame in frames:
            frame_watch = Stopwatch()
            with watch.phase("load"):
                after = read(simulation, f"fluid_{frame:05d}.ply", MOVING, ("id",))
            with watch.phase("foam"), at_once():
                if before is not None:
                    points, full = next_frame(points, before, after, frame, spec, bodies.passing(frame))
                    if full and not warnings:
                        limit = spec.foam.max_particles
                        warnings.append(f"no more than foam.max_particles = {limit} from frame {frame} on")
            with watch.phase("write"):
                write_points(out / f"foam_{frame:05d}.ply", points)
            counts = np.bincount(points["kind"], minlength=len(KINDS)).tolist()
            rows.append({"frame": frame, "particles": len(points), **dict(zip(KINDS, counts, strict=True))})
            progress.report({"frame": frame, "wall_s": frame_watch.report()["total"]})
            before = after
    for warning in warnings:
        print(f"foam: warning: {warning}")
    summary = {
        "status": "done",
        "versions": {name: version(name) for name in (chosen().package, "numpy")},
        "device": device,
        "threads": threads,
        "frames": rows,
        "warnings": warnings,
        "wall_s": watch.report(),
    }
    write_json(out / "summary.json", summary)


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.foam", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help=HELP)
    parser.add_argument(
        "--simulation", required=True, nargs="+", type=Path, metavar="DIR", help="folders with fluid_*.ply"
    )
    parser.add_argument("--frames", required=True, type=frame_range, metavar="A:B", help="first and last frame")
    parser.add_argument("--resume", type=Path, metavar="DIR", help="folder with the foam of the frame before the first")
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for foam_*.ply and summary.json")
    parser.add_argument("--threads", type=positive(int), default=1, metavar="N", help="CPU threads (default 1)")
    parser.add_argument("--arch", choices=("auto", "cpu", "cuda"), default="auto", help="where to compute")
    given = parser.parse_args(argv)

    def work() -> None:
        spec = read_spec(FoamJobSpec, given.spec)
        run(
            spec,
            given.simulation,
            given.frames,
            given.out,
            resume=given.resume,
            threads=given.threads,
            arch=given.arch,
        )

    return exit_code(work, "foam")


if __name__ == "__main__":
    end_with(main, goes_on=True)
