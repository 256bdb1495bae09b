"""Trials become what people look at: a table, a picture of error over cost, and a summary.

It writes trials.csv (a row a simulation), points.csv (a row a combination of settings, with the
medians of its repeats), work_precision.png and .svg, and summary.json. `snakemake studies/NAME`
calls it.

exit codes: 0 done, 1 failed, 2 refused (settings or files cannot be used as they are)
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from common.command import end_with
from common.files import write_json
from scene.settings import Refused
from scene.spec_option import HELP, spec_text
from workflow.stages.film import tables
from workflow.stages.stage import exit_code, refuse_spoiled
from workflow.study import measure
from workflow.study.plot import draw
from workflow.study.points import Outcome, Point, front
from workflow.study.spec import ByTrial, Study

FIGURES = ("steps", "particles", "triangles", "stepping_s", "simulated_s")


def report(spec: Mapping[str, Any], trials: Path, folder: Path, out: Path) -> list[Point]:
    """Write the folder of a study. `trials`: the folder of its trials; `folder`: that of its file. Raises Refused."""
    study = Study.model_validate(spec["study"])
    names = [name for name, _ in spec["trials"]] + ([spec["truth"]] if spec["truth"] else [])
    refuse_spoiled([part for name in names for part in (trials / name).glob("*")], "trial.json", *tables.TABLES)
    if spec["truth"] or isinstance(study.reference, ByTrial):
        found = trials / spec["truth"] / "0"
        if _trial(found)["status"] != "done":
            raise Refused(
                "the trial that all others are compared with failed",
                location=("reference", "set"),
                remedy=f"choose settings that work: {_trial(found).get('message', '')}",
            )
        true = measure.truth_of_trial(study.quantity, study.scale, found)
    else:
        true = measure.truth(study.reference, study.quantity, study.scale, folder)
    points = [
        Point(name, chosen, tuple(_outcome(study, true, trials / name / str(k)) for k in range(study.repeats)))
        for name, chosen in spec["trials"]
    ]
    best = front(points)
    paths = study.paths()
    tables.write(out / "trials.csv", [_rounded(row) for row in _rows_of_trials(points, paths)])
    tables.write(out / "points.csv", [_rounded(row) for row in _rows_of_points(points, best, paths)])
    write_json(out / "summary.json", _summary(spec["name"], study, points, best))
    draw(study, points, spec["name"], out)
    return points


def _trial(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "trial.json").read_text(encoding="utf-8"))


def _outcome(study: Study, true: measure.Truth, folder: Path) -> Outcome:
    data = _trial(folder)
    figures = {key: data.get(key) for key in (*FIGURES, "device")}
    if data["status"] != "done":
        return Outcome(data["status"], data.get("cost"), figures=figures, message=data.get("message", ""))
    value, error = measure.error(study.quantity, true, folder)
    return Outcome("done", data["cost"], value, error, figures)


def _rows_of_trials(points: Iterable[Point], paths: Sequence[str]) -> list[dict[str, Any]]:
    return [
        {"trial": point.name}
        | {path: point.chosen.get(path) for path in paths}
        | {"repeat": k, "status": outcome.status, "value": outcome.value, "error": outcome.error, "cost": outcome.cost}
        | {key: outcome.figures.get(key) for key in FIGURES}
        for point in points
        for k, outcome in enumerate(point.outcomes)
    ]


def _rows_of_points(points: Iterable[Point], best: Sequence[Point], paths: Sequence[str]) -> list[dict[str, Any]]:
    return [
        {"trial": point.name}
        | {path: point.chosen.get(path) for path in paths}
        | {"status": point.status, "error": point.error, "cost": point.cost}
        | {"cost_least": min(point.costs, default=None), "cost_most": max(point.costs, default=None)}
        | {"on_front": int(point in best)}
        for point in points
    ]


def _rounded(row: Mapping[str, Any]) -> dict[str, Any]:
    return {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()}


def _summary(name: str, study: Study, points: Sequence[Point], best: Sequence[Point]) -> dict[str, Any]:
    statuses = [point.status for point in points]
    devices = {str(outcome.figures.get("device")) for point in points for outcome in point.outcomes}
    return {
        "name": name,
        "description": study.description,
        "trials": len(points),
        "repeats": study.repeats,
        "status": {status: statuses.count(status) for status in sorted(set(statuses))},
        "devices": sorted(devices),
        "front": [{**point.chosen, "error": point.error, "cost": point.cost} for point in best],
        "failures": [
            {**point.chosen, "status": point.status, "message": point.outcomes[0].message}
            for point in points
            if point.status != "done"
        ],
    }


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.study", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help=HELP)
    parser.add_argument("--trials", required=True, type=Path, metavar="DIR", help="folder with TRIAL/REPEAT/trial.json")
    parser.add_argument("--folder", required=True, type=Path, metavar="DIR", help="where the reference's path starts")
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for table and plots")
    given = parser.parse_args(argv)

    def work() -> None:
        given.out.mkdir(parents=True, exist_ok=True)
        spec = json.loads(spec_text(given.spec))
        points = report(spec, given.trials, given.folder, given.out)
        unit = "s/s" if spec["study"].get("stage", "simulate") == "simulate" else "s/frame"
        for point in front(points):
            settings = ", ".join(f"{path} {value}" for path, value in point.chosen.items())
            cost, error = point.found
            print(f"{100 * error:10.4g} %  {cost:10.4g} {unit}  {settings}")

    return exit_code(work, "study")


if __name__ == "__main__":
    end_with(main, goes_on=True)
