"""Check, explain, run or play the simulation of a scene file, without the rest of the pipeline."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from common.arguments import frame_range, not_negative, positive
from common.command import as_called, end_with, go_on_unheard
from common.frames import Frames
from scene import assets
from scene.settings import Refused

if TYPE_CHECKING:
    from scene.load import Scene

COMMAND = "python -m sim"
FAILED = 1
REFUSED = 2

EXAMPLES = """\
examples:
  python -m sim check scenes/bunny.yaml
      validate the scene at each of its presets; nothing is simulated
  python -m sim explain scenes/bunny.yaml
      what it models, what it leaves out and could leave out, and what it costs; --measure tries that out
  python -m sim run scenes/bunny.yaml --out out --quality draft
      simulate all frames into out/: fluid_00042.ply, bodies.csv, steps.csv, state_00072.npz, summary.json
  python -m sim run scenes/bunny.yaml --out out --set fluid.viscosity=0.01 --set gravity='[0, -1.62, 0]'
      the same with other values
  python -m sim run scenes/bunny.yaml --out more --resume out/state_00024.npz
      go on from a state
  python -m sim live scenes/duck.yaml --quality draft
      play it in a browser, change it while it runs, and save what was done as a scene

exit status: 0 done, 1 failed, 2 refused (the message names field, line and remedy), 3 stopped by the failure
policy (see failure.json; the last good state is kept), 130 interrupted, 141 nobody read all that was printed
"""


def main(arguments: list[str] | None = None, called: str = COMMAND) -> int:
    parser = argparse.ArgumentParser(
        prog=called,
        description=__doc__,
        epilog=as_called(EXAMPLES, called),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    check = commands.add_parser("check", help="validate a scene file")
    explain = commands.add_parser("explain", help="say what a scene models and what it could leave out")
    run = commands.add_parser("run", help="simulate a scene file")
    live = commands.add_parser("live", help="play a scene in a browser, and change it while it runs")
    for command in (check, explain, run, live):
        command.add_argument("scene", help="scene file, such as scenes/bunny.yaml, or its name, such as bunny")
        command.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="override a setting")
        command.add_argument("--quality", metavar="Q", help="preset: draft, standard or final (default: the scene's)")
        command.add_argument(
            "--allow", action="append", default=[], metavar="DIR", help="let the scene read below this folder, too"
        )
    explain.add_argument(
        "--measure",
        action="store_true",
        help="predict time and disk of the film, after coarse copies of it on all cores",
    )
    _add_run_options(run)
    _add_live_options(live)
    options = parser.parse_args(arguments)
    try:
        assets.allow(options.allow)
    except Refused as refused:
        print(f"refused: --allow: {refused}", file=sys.stderr)
        return REFUSED
    return {"check": _check, "explain": _explain, "run": _run, "live": _live}[options.command](options)


def _add_run_options(run: argparse.ArgumentParser) -> None:
    run.add_argument("--out", type=Path, required=True, help="folder for frames, tables and state")
    run.add_argument("--frames", type=frame_range, metavar="A:B", help="frames to write, both included (default: all)")
    run.add_argument("--resume", type=Path, metavar="STATE", help="go on from this state_*.npz")
    _add_device(run)
    run.add_argument("--quiet", action="store_true", help="no progress")


def _add_live_options(live: argparse.ArgumentParser) -> None:
    live.add_argument("--port", type=int, default=8080, help="of the page (default: 8080, or the next that is free)")
    live.add_argument(
        "--host", default="127.0.0.1", help="address to listen at (default: 127.0.0.1; others ask viewers for a token)"
    )
    live.add_argument("--play", action="store_true", help="play at once instead of waiting for the button")
    live.add_argument("--stop-when-left", action="store_true", help="end when the last page is closed")
    live.add_argument(
        "--history", type=not_negative(float), default=1.0, metavar="GB", help="memory for going back (default: 1)"
    )
    _add_device(live)


def _add_device(command: argparse.ArgumentParser) -> None:
    command.add_argument("--threads", type=positive(int), help="CPU threads (default: all; small scenes take one)")
    command.add_argument("--arch", choices=("auto", "cpu", "cuda"), default="auto", help="default: CUDA if there")


def _load(options: argparse.Namespace, quality: str | None) -> Scene:
    """The scene that the options name; raises SceneError."""
    from scene.load import load
    from workflow.plan.shelf import SCENE_FILES

    return load(SCENE_FILES.locate(options.scene), quality=quality, overrides=options.set)


def _check(options: argparse.Namespace) -> int:
    from scene.document import SceneError
    from scene.load import combination_of
    from scene.presets import QUALITIES
    from sim.checks.preview import preview
    from workflow.plan.foreseen import cautions, refuse_pictures

    qualities = [options.quality] if options.quality else list(QUALITIES)
    try:
        for quality in qualities:
            scene = _load(options, quality)
            try:
                found = preview(scene.simulation, scene.folder)
                refuse_pictures(scene, found)
            except Refused as refused:
                raise scene.error(refused) from None
            print(f"{options.scene} ({quality}): {scene.last_frame + 1} frames, {found.contents}")
            for caution in (*found.cautions, *cautions(scene, found)):
                print(f"  {scene.warning(caution)}")
            for combination in scene.wedge:
                combination_of(scene, combination.name, options.set)
            if scene.wedge:
                print(f"{options.scene} ({quality}): {len(scene.wedge)} combinations, all valid")
    except SceneError as error:
        print(error, file=sys.stderr)
        return REFUSED
    return 0


def _explain(options: argparse.Namespace) -> int:
    from scene.document import SceneError
    from sim.checks.explain import explain
    from workflow.budget.pilot import PilotFailed
    from workflow.plan.costs import costs, measured

    try:
        scene = _load(options, options.quality)
        try:
            found = explain(scene.simulation, scene.folder, scene.duration)
        except Refused as refused:
            raise scene.error(refused) from None
        prices = costs(scene) + (measured(scene, options.set) if options.measure else [])
    except SceneError as error:
        print(error, file=sys.stderr)
        return REFUSED
    except PilotFailed as failed:
        print(f"a coarse copy of {options.scene} failed, so that nothing can be predicted\n{failed}", file=sys.stderr)
        return FAILED
    print(f"{options.scene} ({scene.quality}): {scene.duration:g} s, {scene.last_frame + 1} frames")
    parts = {"models": found.models, "leaves out": found.leaves_out, "could leave out": found.could_leave_out}
    parts["costs"] = prices
    width = max(len(line.subject) for lines in parts.values() for line in lines)
    for title, lines in parts.items():
        print(f"\n{title}{'' if lines else ': nothing'}")
        for line in lines:
            print(f"  {line.subject:<{width}}  {line.text}")
    return 0


def _run(options: argparse.Namespace) -> int:
    from sim.segment import guarded

    go_on_unheard()
    return guarded(lambda: _simulate(options))


def _simulate(options: argparse.Namespace) -> int:
    from scene.diagnostics import idle
    from scene.document import SceneError
    from sim.run.checkpoint import frame_of
    from sim.segment import simulate

    try:
        scene = _load(options, options.quality)
    except SceneError as error:
        print(error, file=sys.stderr)
        return REFUSED
    if not options.quiet:
        for caution in idle.cautions(scene):
            print(scene.warning(caution), file=sys.stderr)
    first = frame_of(options.resume) + 1 if options.resume else 0
    asked = options.frames or Frames(first, scene.last_frame)
    try:
        return simulate(
            scene.simulation,
            scene.folder,
            options.out,
            first=asked.first,
            last=asked.last,
            state=options.resume,
            threads=options.threads,
            arch=options.arch,
            quiet=options.quiet,
        )
    except Refused as refused:
        print(scene.error(refused), file=sys.stderr)
        return REFUSED


def _live(options: argparse.Namespace) -> int:
    from sim.segment import guarded

    go_on_unheard()
    return guarded(lambda: _play(options))


def _play(options: argparse.Namespace) -> int:
    from live.serve import serve
    from scene.document import SceneError

    try:
        scene = _load(options, options.quality)
    except SceneError as error:
        print(error, file=sys.stderr)
        return REFUSED
    try:
        return serve(scene, options)
    except Refused as refused:
        print(scene.error(refused), file=sys.stderr)
        return REFUSED


if __name__ == "__main__":
    end_with(main)
