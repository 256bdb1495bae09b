"""What fluid has wetted: folders of fluid_00042.ply become a folder of wet_body_NAME_00042.ply and others.

example: what is wet in the first second of a simulation with particles of 1 cm radius
  python -m workflow.wet --spec '{"drying_time": 10, "particle_radius": 0.01, "fps": 24}' \\
      --simulation run/simulation --frames 0:24 --out run/wet

--spec takes JSON, the name of a file with it, or - for standard input: drying_time [s], particle_radius [m] of the
fluid, fps, `walls`, planes of which the level ones are floors, and `vessels`, names of containers that can be wet.
Rigid bodies, containers and cloth are read from the folders of the simulation. Frames that begin later go on from
--resume, the folder with what was wet in the frame before.

Files of bodies, containers and floors hold the points that are wet of a lattice in their axes, whose cells are as large
as summary.json says; those of cloth hold all its vertices. Each has x, y, z [m] and `wet`, from 0 to 1.

exit codes: 0 done, 1 failed, 2 refused (settings or files cannot be used as they are)
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from common.arguments import frame_range
from common.command import end_with
from common.files import write_json
from common.frames import Frames
from common.signals import at_once
from common.stopwatch import Stopwatch
from render.progress import Progress
from scene.settings import Refused
from scene.spec_option import HELP, read_spec
from workflow.stages import stage
from workflow.stages.stage import exit_code
from workflow.stages.wet.spec import WetJobSpec

if TYPE_CHECKING:
    import numpy as np

FLOOR = "floor"


def run(spec: WetJobSpec, simulation: Sequence[Path], frames: Frames, out: Path, *, resume: Path | None = None) -> None:
    """Write wet_*.ply and summary.json to `out`; raises Refused for files that cannot be used."""
    watch = Stopwatch()
    if frames.first > 0 and resume is None:
        remedy = "give --resume, or start at frame 0"
        raise Refused(f"frame {frames.first} needs what was wet in frame {frames.first - 1}", remedy=remedy)
    with watch.phase("import"):
        import numpy as np

        from common.ply import write_points
        from workflow.stages.bodies import Bodies
        from workflow.stages.points import read
        from workflow.stages.wet import marks
    with watch.phase("load"):
        stage.refuse_spoiled(simulation, "fluid_", "cloth_", "body_", "bodies", "container_", frames=frames)
        stage.refuse_spoiled([resume] if resume else [], "wet_", frames=range(frames.first - 1, frames.first))
        bodies = Bodies(simulation)
        before = _before(resume, frames.first - 1) if resume else {}
    out.mkdir(parents=True, exist_ok=True)
    cell = 2 * spec.particle_radius
    loss = 1.0 / (spec.fps * spec.drying_time)
    heights = marks.floors(spec.walls)
    cloth = {name: points["wet"] for name, points in before.items() if name.startswith("cloth_")}
    wet = {name: marks.Marks.read(points, cell) for name, points in before.items() if name not in cloth}
    rows = []
    with Progress(len(frames)) as progress:
        for frame in frames:
            frame_watch = Stopwatch()
            with watch.phase("load"):
                fluid = _vectors(read(simulation, f"fluid_{frame:05d}.ply", "xyz"))
                solids = bodies.named_solids(frame, spec.vessels)
                sheets = {
                    name: read([path.parent], path.name, "xyz") for name, path in _sheets(simulation, frame).items()
                }
            with watch.phase("wet"), at_once():
                feet = {name: marks.feet_on_solid(fluid, solid, cell) for name, solid in solids.items()}
                if heights:
                    feet[FLOOR] = np.concatenate([marks.feet_on_floor(fluid, height, cell) for height in heights])
                wet = marks.lattices(wet, feet, cell, loss)
                cloth = {
                    name: marks.wet_cloth(
                        _vectors(sheet), cloth.get(name, np.zeros(len(sheet), np.float32)), fluid, cell, loss
                    )
                    for name, sheet in sheets.items()
                }
            with watch.phase("write"):
                found = {name: part.points(cell) for name, part in wet.items()}
                found |= {name: _at_vertices(sheets[name], values) for name, values in cloth.items()}
                for name, points in found.items():
                    write_points(out / f"wet_{name}_{frame:05d}.ply", points)
            rows.append({"frame": frame, "wet": {name: int((one["wet"] > 0).sum()) for name, one in found.items()}})
            progress.report({"frame": frame, "wall_s": frame_watch.report()["total"]})
    summary = {
        "status": "done",
        "versions": {name: version(name) for name in ("numpy", "scipy")},
        "cell": cell,
        "floors": heights,
        "frames": rows,
        "wall_s": watch.report(),
    }
    write_json(out / "summary.json", summary)


def _before(folder: Path, frame: int) -> dict[str, np.ndarray]:
    """The points of all parts in the frame before the first, by the names of their files; raises Refused."""
    from workflow.stages.points import read

    ending = f"_{frame:05d}.ply"
    paths = sorted(folder.glob(f"wet_*{ending}"))
    if not (folder / "summary.json").exists():
        raise Refused(f"{folder} has no summary.json, so that what was wet is not known", remedy="make it first")
    names = (path.name.removeprefix("wet_").removesuffix(ending) for path in paths)
    return {name: read([folder], path.name, ("x", "y", "z", "wet")) for name, path in zip(names, paths, strict=True)}


def _sheets(folders: Sequence[Path], frame: int) -> Mapping[str, Path]:
    """The files of cloth of a frame, by `cloth_NAME`."""
    paths = (path for folder in folders for path in sorted(folder.glob(f"cloth_*_{frame:05d}.ply")))
    return {re.sub(r"_\d+$", "", path.stem): path for path in paths}


def _vectors(points: Any) -> Any:
    import numpy as np

    return np.stack([points[axis] for axis in "xyz"], axis=1).astype(np.float64)


def _at_vertices(sheet: Any, wet: Any) -> Any:
    import numpy as np

    from workflow.stages.wet.marks import WET_POINT

    found = np.empty(len(sheet), WET_POINT)
    for axis in "xyz":
        found[axis] = sheet[axis]
    found["wet"] = wet
    return found


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.wet", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help=HELP)
    parser.add_argument(
        "--simulation", required=True, nargs="+", type=Path, metavar="DIR", help="folders with fluid_*.ply"
    )
    parser.add_argument("--frames", required=True, type=frame_range, metavar="A:B", help="first and last frame")
    parser.add_argument(
        "--resume", type=Path, metavar="DIR", help="folder with what was wet in the frame before the first"
    )
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for wet_*.ply and summary.json")
    given = parser.parse_args(argv)

    def work() -> None:
        spec = read_spec(WetJobSpec, given.spec)
        run(spec, given.simulation, given.frames, given.out, resume=given.resume)

    return exit_code(work, "wet")


if __name__ == "__main__":
    end_with(main, goes_on=True)
