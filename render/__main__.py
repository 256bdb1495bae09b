"""Command line of the render stage."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from common.arguments import frame_range, positive, rate
from common.command import end_with
from common.files import write_json
from common.manifest import spoiled
from common.registry import added, packages
from common.signals import at_once
from common.simulation_files import SOURCES
from render import program
from render.errors import RenderError, Unusable
from render.job import FORMATS, Job
from render.progress import Progress
from render.spec import RenderSpec
from scene.settings import Refused
from scene.spec_option import HELP, read_spec

EXAMPLE = """\
example: the first two seconds of a film, after its simulation and reconstruction
  python -m render --spec '{"samples": 16}' --simulation run/sim --surface run/surface \\
      --frames 0:47 --out run/frames

--spec takes the `render:` section of a scene as JSON, the name of a file with it, or - for standard input;
'{}' is all defaults.
It writes run/frames/00000.png ... 00047.png and run/frames/summary.json.
With --save-blend scene.blend the first frame can be opened and changed in Blender.

exit codes: 0 done, 1 failed, 2 refused (settings, files or machine cannot be used as they are)
"""


def main(arguments: list[str] | None = None) -> int:
    """Render a block of frames; returns the exit code."""
    options = _parse(arguments)
    with tempfile.TemporaryDirectory(prefix="render-") as scratch:
        log = Path(options.log) if options.log else Path(scratch) / "blender.log"
        try:
            _render(options, log, Path(scratch))
        except RenderError as error:
            print(f"render: {error}", file=sys.stderr)
            if error.exit_code == RenderError.exit_code:
                _print_tail(log)
            return error.exit_code
        except OSError as error:
            print(f"render: {error.strerror}: {error.filename}", file=sys.stderr)
            return RenderError.exit_code
    return 0


def _render(options: argparse.Namespace, log: Path, scratch: Path) -> None:
    start = time.perf_counter()
    spec = _load_spec(options.spec)
    out = _make_folder(options.out)
    for folder in filter(None, (options.simulation, options.surface, options.foam, options.wet)):
        if not Path(folder).is_dir():
            raise Unusable(f"{folder} is not a folder")
    _refuse_spoiled(options)
    job = Job(
        settings=_with_builders(spec.model_dump(mode="json")),
        simulation=os.path.abspath(options.simulation),
        surface=os.path.abspath(options.surface) if options.surface else None,
        foam=os.path.abspath(options.foam) if options.foam else None,
        wet=os.path.abspath(options.wet) if options.wet else None,
        first=options.frames.first,
        last=options.frames.last,
        out=str(out.resolve()),
        log=str(log.resolve()),
        fps=options.fps,
        threads=options.threads,
        packages=_files(packages("looks")),
        save_blend=os.path.abspath(options.save_blend) if options.save_blend else None,
        export=_export_path(options.export),
        particles=options.particles,
        voxel=options.voxel,
    )
    with Progress(len(job.frames())) as progress:
        blender = options.blender or program.chosen()
        if blender is not None:
            from render.blender.installed import render_installed

            summary = render_installed(blender, job, scratch, progress.report)
        else:
            before = time.perf_counter()
            from render.blender.work import carry_out

            imported = time.perf_counter() - before
            with at_once():
                summary = carry_out(job, progress.report)
            summary["wall_s"] = {"import": imported, **summary["wall_s"]}
    summary["wall_s"]["total"] = time.perf_counter() - start
    for warning in summary["warnings"]:
        print(f"render: warning: {warning}", file=sys.stderr)
    write_json(out / "summary.json", {"status": "done", **summary})


def _files(names: set[str]) -> dict[str, str]:
    """The file of each package, `__init__.py` where it is a folder."""
    found = {name: find_spec(name) for name in sorted(names)}
    return {name: spec.origin for name, spec in found.items() if spec is not None and spec.origin is not None}


def _with_builders(settings: Any) -> Any:
    """The settings, in which looks that installed packages add say what builds them."""
    if isinstance(settings, list):
        return [_with_builders(value) for value in settings]
    if not isinstance(settings, dict):
        return settings
    found = {key: _with_builders(value) for key, value in settings.items()}
    look = added("looks").get(str(found.get("type")))
    return found if look is None else found | {"build": look.IMPLEMENTATION}


def _refuse_spoiled(options: argparse.Namespace) -> None:
    """Refuse files of earlier stages that are no longer what they were made as."""
    read = {
        options.simulation: ("cloth_", "body_", "container_", "bodies.csv", SOURCES, "summary.json"),
        options.surface: ("surface_",),
        options.foam: ("foam_",),
        options.wet: ("wet_", "summary.json"),
    }
    for folder, kinds in read.items():
        path = spoiled(Path(folder), kinds, options.frames) if folder else None
        if path is not None:
            raise Unusable(
                f"{path} no longer holds what was written to it\n"
                f"  fix: delete the folder {folder} and run the same command again: what is in it is made anew"
            )


def _export_path(name: str | None) -> str | None:
    if name is None:
        return None
    if Path(name).suffix not in FORMATS:
        raise Unusable(f"--export: {name} is of no kind that can be written: use {', '.join(FORMATS)}")
    _make_folder(os.path.dirname(os.path.abspath(name)))
    return os.path.abspath(name)


def _load_spec(given: str) -> RenderSpec:
    try:
        return read_spec(RenderSpec, given)
    except Refused as refused:
        raise Unusable(str(refused)) from None


def _make_folder(name: str) -> Path:
    path = Path(name)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RenderError(f"cannot make the folder {path}: {error.strerror}") from error
    if not os.access(path, os.W_OK):
        raise RenderError(f"the folder {path} cannot be written")
    return path


def _print_tail(log: Path, count: int = 20) -> None:
    """Show what Blender said at last, without its progress."""
    if log.exists():
        lines = [line for line in log.read_text(errors="replace").splitlines() if not line.startswith("Fra:")]
        print(*lines[-count:], sep="\n", end="", file=sys.stderr)


def _parse(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m render",
        description="Render a block of frames with Blender's Cycles.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help=HELP)
    parser.add_argument("--simulation", required=True, metavar="DIR", help="folder that the simulation wrote")
    parser.add_argument("--surface", metavar="DIR", help="folder of the water's surfaces; left out for a dry scene")
    parser.add_argument("--foam", metavar="DIR", help="folder of its foam; left out for a scene without")
    parser.add_argument("--wet", metavar="DIR", help="folder of what is wet; left out where nothing shows it")
    parser.add_argument(
        "--frames", required=True, type=frame_range, metavar="A:B", help="first and last, both included"
    )
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the pictures and summary.json")
    parser.add_argument("--fps", type=rate, default=24.0, help="frames per simulated second (default 24)")
    parser.add_argument("--threads", type=positive(int), metavar="N", help="CPU threads (default: all)")
    parser.add_argument("--save-blend", metavar="FILE", help="also save the first frame's scene as a .blend file")
    parser.add_argument(
        "--export",
        metavar="FILE",
        help="write the animation to this file instead of pictures: .usdc, .usda, .abc, .glb or .blend; or, "
        "as .vdb, a volume a frame beside it",
    )
    parser.add_argument(
        "--particles",
        type=positive(float),
        metavar="RADIUS",
        help="let the exported file have the fluid's particles too, as points of this radius [m]",
    )
    parser.add_argument(
        "--voxel", type=positive(float), metavar="EDGE", help="of a .vdb [m] (default: the spacing of the particles)"
    )
    parser.add_argument(
        "--blender",
        metavar="PATH",
        help=f"an installed Blender instead of the package bpy (default: ${program.VARIABLE}, if set)",
    )
    parser.add_argument("--log", metavar="FILE", help="keep what Blender prints in this file")
    return parser.parse_args(arguments)


def _main() -> int:
    """`main`, and the end of the process where the package bpy would wait for ever: after its exporter of glTF ran, it
    does not end its threads before it takes down what they wait for (Blender 4.5)."""
    status = main()
    if "io_scene_gltf2.blender.exp" in sys.modules:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
    return status


if __name__ == "__main__":
    end_with(_main, goes_on=True)
