"""Progress of a film: stage, frames, time left, and the last picture.

    python -m workflow.status bunny              once
    python -m workflow.status bunny --watch      until the film is there

It reads what the jobs leave on disk, so it works during a run of Snakemake, also from another machine that shares the
disk. The time left follows from what finished parts took, and from how many parts are in progress.
"""

from __future__ import annotations

import argparse
import csv
import re
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from common.command import as_called, end_with
from common.distribution import HOME
from common.manifest import Manifest
from common.time_left import duration
from scene.document import SceneError
from scene.load import load
from scene.presets import QUALITIES
from scene.settings import Refused
from workflow.plan.jobs import Job, Plan
from workflow.plan.shelf import SCENE_FILES

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

COMMAND = "python -m workflow.status"
STAGES = {"simulate": "simulation", "reconstruct": "surface", "foam": "foam", "wet": "wet", "render": "frames"}
"""Stages that are made in parts, and the folders of their results."""
REFRESH = 1.0
"""[s]"""
_NUMBER = re.compile(r"(?:^|_)(\d{5,})\.(?:ply|png)$")


@dataclass(frozen=True)
class Progress:
    """Of one stage; `seconds` are those that a frame took in finished parts."""

    stage: str
    frames: int
    done: int
    running: int
    outdated: int
    seconds: float | None

    @property
    def left(self) -> float | None:
        """Work that is left, if done by one job after another [s]; None before the first part is done."""
        missing = self.frames - self.done
        if missing == 0:
            return 0.0
        return None if self.seconds is None else missing * self.seconds


def progress(plan: Plan, stage: str) -> Progress:
    """How far a stage of a film is, by what is on the disk."""
    done = running = outdated = timed = 0
    wall = 0.0
    for index, job in enumerate(plan.jobs(stage)):
        manifest = Manifest.read(Path(job.folder))
        if manifest is not None and manifest.plan == job.plan:
            done += len(job.frames)
            seconds = _wall(Path(plan.results, "benchmarks", STAGES[stage], f"{index:03d}.tsv"))
            if seconds is not None:
                wall, timed = wall + seconds, timed + len(job.frames)
            continue
        outdated += len(job.frames) if manifest is not None else 0
        begun = _begun(job)
        if begun is not None:
            running += 1
            done += begun
    frames = sum(len(job.frames) for job in plan.jobs(stage))
    return Progress(stage, frames, done, running, outdated, wall / timed if timed else None)


def _begun(job: Job) -> int | None:
    """Frames that a part which is being made has; None where it is not being made."""
    folder = Path(job.folder)
    for partial in folder.parent.glob(f".{folder.name}.partial-*"):
        numbers = {found[1] for path in partial.glob("*.p[ln][yg]") if (found := _NUMBER.search(path.name))}
        return min(len(numbers), len(job.frames))
    return None


def _wall(path: Path) -> float | None:
    try:
        with path.open(newline="") as stream:
            return float(next(csv.DictReader(stream, delimiter="\t"))["s"])
    except (OSError, ValueError, KeyError, StopIteration):
        return None


def last_picture(plan: Plan) -> Path | None:
    """The newest frame that was rendered."""
    folder = Path(plan.results, "frames")
    pictures = [*folder.glob("[0-9]*/*.png"), *folder.glob(".*.partial-*/*.png")]
    return max(pictures, key=lambda path: path.stat().st_mtime, default=None)


def report(plan: Plan) -> tuple[Table, bool]:
    """The table that is shown, and whether the film is there."""
    from rich.progress_bar import ProgressBar
    from rich.table import Table

    stages = [progress(plan, stage) for stage in STAGES if plan.parts(stage)]
    film = plan.job("film")
    manifest = Manifest.read(Path(film.folder))
    finished = manifest is not None and manifest.plan == film.plan
    table = Table(title=f"{plan.scene.name}, {plan.scene.quality}", title_justify="left", box=None, pad_edge=False)
    for column in ("stage", "", "frames", "jobs now", "a frame", "left"):
        table.add_column(column, justify="left" if column in ("stage", "") else "right")
    for item in stages:
        bar = ProgressBar(total=item.frames, completed=item.done, width=24)
        again = f" ({item.outdated} anew)" if item.outdated else ""
        rate = "" if item.seconds is None else f"{item.seconds:.3g} s"
        left = "" if item.left is None else duration(item.left / max(1, item.running))
        table.add_row(item.stage, bar, f"{item.done}/{item.frames}{again}", str(item.running or ""), rate, left)
    table.caption = _summary(stages, film, finished, last_picture(plan))
    table.caption_justify = "left"
    return table, finished


def _console() -> Console:
    """One that leaves it to the command what comes of a reader that has gone."""
    from rich.console import Console

    class Plain(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError

    return Plain()


def _summary(stages: list[Progress], film: Job, finished: bool, picture: Path | None) -> str:
    if finished:
        return f"the film is in {film.folder}"
    known = [item.left for item in stages if item.left is not None]
    running = sum(item.running for item in stages)
    left = duration(sum(known) / max(1, running))
    if not running:
        text = "nothing is being made" + (f"; one job after another would take {left}" if any(known) else "")
    elif len(known) < len(stages):
        text = f"more than {left} left: not every stage has finished a part yet"
    else:
        text = f"about {left} left"
    return text + (f"\nlast picture: {picture}" if picture else "")


def main(arguments: list[str] | None = None, called: str = COMMAND) -> int:
    parser = argparse.ArgumentParser(
        prog=called,
        description=as_called(__doc__, called),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scene", help="name of a scene, such as bunny, or its file")
    parser.add_argument("--quality", choices=QUALITIES, help="of the film (default: the scene's)")
    parser.add_argument("--watch", action="store_true", help="go on until the film is there")
    options = parser.parse_args(arguments)
    try:
        scene = load(SCENE_FILES.locate(options.scene), quality=options.quality)
    except (SceneError, Refused) as error:
        print(f"status: {error}", file=sys.stderr)
        return 2
    plan = Plan(scene, HOME)
    from rich.live import Live

    table, finished = report(plan)
    if not options.watch:
        _console().print(table)
        return 0
    try:
        with Live(table, console=_console()) as live:
            while not finished:
                time.sleep(REFRESH)
                table, finished = report(plan)
                live.update(table)
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    end_with(main)
