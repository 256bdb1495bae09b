"""The films of a wedge become one contact sheet (contact.png) and one table (table.csv).

`snakemake wedges/NAME` calls it, for a scene with `wedge:`. table.csv has a row a film: the values,
how it ended, particles, steps, warnings, and the wall seconds of each stage.

exit codes: 0 done, 1 failed, 2 refused (settings or files cannot be used as they are)
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from common.command import end_with
from common.files import write_whole
from scene.spec_option import HELP, spec_text
from workflow.stages.film import tables
from workflow.stages.film.contact_sheet import Cell, chosen, draw_sheet
from workflow.stages.film.summaries import read
from workflow.stages.stage import exit_code, refuse_spoiled

STRIP = 4
"""Pictures of each film, while there are few films; of many, its last."""
FEW = 12
WIDTH = 1920
"""Of the sheet [px]."""
STAGES = ("simulate", "reconstruct", "render")


def report(spec: Mapping[str, Any], out: Path) -> None:
    """Write the folder of a wedge; raises Refused for files of films that something has spoiled."""
    films = spec["films"]
    refuse_spoiled([Path(film["folder"]) for film in films], "frames/", "summary.json")
    summaries = [read(Path(film["folder"])) for film in films]
    rows = [_row(film, summary) for film, summary in zip(films, summaries, strict=True)]
    tables.write(out / "table.csv", rows)
    few = len(films) <= FEW
    wanted = STRIP if few else 1
    cells = [cell for film, summary in zip(films, summaries, strict=True) for cell in _cells(film, summary, wanted)]
    columns = STRIP if few else math.ceil(math.sqrt(len(cells)))
    sheet = draw_sheet(cells, columns=columns, width=WIDTH, title=spec["name"], about=f"{len(films)} combinations")
    write_whole(out / "contact.png", lambda partial: sheet.save(partial, format="PNG"))


def _cells(film: Mapping[str, Any], summary: Mapping[str, Any], wanted: int) -> list[Cell]:
    pictures = sorted(Path(film["folder"], "frames").glob("*.png"))
    frames = chosen(len(pictures), wanted) if wanted > 1 else [len(pictures) - 1]
    label = film["name"].partition("@")[2]
    captions = [label] + [""] * (len(frames) - 1)
    return [
        Cell(pictures[frame], caption, f"{frame / summary['fps']:.2f} s")
        for frame, caption in zip(frames, captions, strict=True)
    ]


def _row(film: Mapping[str, Any], summary: Mapping[str, Any]) -> dict[str, Any]:
    counts, wall = summary["counts"], summary["wall_s"]
    return (
        {"name": film["name"]}
        | film["chosen"]
        | {"status": summary["status"], "frames": summary["frames"], "simulated_s": summary["simulated_s"]}
        | {"steps": counts.get("steps"), "particles": counts.get("particles"), "warnings": len(summary["warnings"])}
        | {f"{stage}_s": wall.get(stage, {}).get("total", 0.0) for stage in STAGES}
    )


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.wedge", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help=HELP)
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the sheet and the table")
    given = parser.parse_args(argv)

    def work() -> None:
        given.out.mkdir(parents=True, exist_ok=True)
        report(json.loads(spec_text(given.spec)), given.out)

    return exit_code(work, "wedge")


if __name__ == "__main__":
    end_with(main, goes_on=True)
