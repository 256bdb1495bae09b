"""What studies that speak for a material found, by settings."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from common.distribution import HOME
from scene.grid import setting
from scene.load import Scene
from scene.reader import read
from scene.settings import Refused
from workflow.budget.spacings import fineness_of_spacing, is_spacing
from workflow.plan.shelf import STUDIES, STUDY_FILES
from workflow.study.load import LoadedStudy, Trial, load_study

MEASURED = HOME / STUDY_FILES.folder / "measured"
"""Tables of points that come with the project, for studies that were not carried out here."""
SAME = 1.25
"""Costs that differ by less than this factor are the same: a machine is not more even."""
GREATER_IS_FINER = frozenset({"substeps", "max_iterations"})
"""Settings whose greater values are the more exact ones."""


@dataclass(frozen=True)
class Measured:
    """One combination of a study's settings. `error` is none where it failed."""

    study: str
    chosen: Mapping[str, Any]
    """By path, without spacings and names."""
    fineness: Mapping[str, float]
    """By path, greater for what is finer; of spacings how many go over the size of the material."""
    names: Mapping[str, str | bool]
    """By path: what has to be as in a scene, as `fluid.solver`; names and truths."""
    error: float | None
    cost: float
    changes: int = 0
    """How many of the chosen settings the scene has otherwise."""

    def finer(self, other: Measured) -> bool:
        """Whether it is at least as fine as another in all that varies."""
        return all(self.fineness.get(path, 0.0) >= value for path, value in other.fineness.items())


def evidence(material: str, scene: Scene) -> list[list[Measured]]:
    """The points of every study that speaks for a material of a scene, at the scene's solver; raises Refused,
    SceneError."""
    settings = scene.simulation.model_dump(mode="json")
    found = []
    for name in speakers(material):
        loaded = load_study(STUDY_FILES.find(name), name)
        points = [_beside(point, settings) for point in _points(loaded) if _alike(point, settings)]
        if points:
            found.append(points)
    if not found:
        raise Refused(
            f"--config error: no study speaks for {material} as in {scene.path}",
            remedy="choose another solver or integrator, or write a study with `speaks_for` and carry it out",
        )
    return found


def speakers(material: str) -> list[str]:
    """Names of the studies that speak for a material."""
    return [name for name in STUDY_FILES.names() if read(STUDY_FILES.find(name)).data.get("speaks_for") == material]


def cheapest(points: Sequence[Measured], error: float) -> Measured | None:
    """The cheapest point with at most this error, which no finer one exceeds: an error that is small by chance does
    not count. Of those that cost as much, one that leaves settings as they are."""
    trusted = [point for point in points if _worst(point, points) <= error]
    bound = SAME * min((point.cost for point in trusted), default=0.0)
    alike = [point for point in trusted if point.cost <= bound]
    return min(alike, key=lambda point: (point.changes, point.cost), default=None)


def least_error(points: Sequence[Measured]) -> float:
    """What the best point can be trusted with; infinite where all failed."""
    return min(_worst(point, points) for point in points)


def _worst(point: Measured, points: Iterable[Measured]) -> float:
    errors = [other.error for other in points if other.finer(point)]
    return max(float("inf") if error is None else error for error in errors)


def _points(loaded: LoadedStudy) -> Iterable[Measured]:
    trials = {trial.name: trial for trial in loaded.trials}
    with _table(loaded.name).open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["trial"] in trials and row["cost"]:
                yield _measured(loaded, trials[row["trial"]], row)


def _table(name: str) -> Path:
    """Of the last study on this machine, or of that which comes with the project."""
    own, shipped = Path(STUDIES, name, "points.csv"), MEASURED / f"{name}.csv"
    for path in (own, shipped):
        if path.is_file():
            return path
    raise Refused(f"--config error: study {name} was not carried out", remedy=f"snakemake --cores all {STUDIES}/{name}")


def _measured(loaded: LoadedStudy, trial: Trial, row: Mapping[str, str]) -> Measured:
    settings = trial.scene.simulation.model_dump(mode="json")
    chosen, fineness, names = {}, {}, {}
    for path, value in trial.chosen.items():
        found = setting(settings, path)
        if is_spacing(path):
            fineness[path] = fineness_of_spacing(trial.scene, path)
        elif isinstance(found, str | bool):
            names[path] = found
        else:
            chosen[path] = value
            fineness[path] = _fineness(path, found)
    error = float(row["error"]) if row["status"] == "done" else None
    return Measured(loaded.name, chosen, fineness, names, error, float(row["cost"]))


def _beside(point: Measured, settings: Mapping[str, Any]) -> Measured:
    """The point with its changes of a scene."""
    own = ((_fineness(path, setting(settings, path)), point.fineness[path]) for path in point.chosen)
    return replace(point, changes=sum(not math.isclose(*pair) for pair in own))


def _fineness(path: str, value: float) -> float:
    if path.rpartition(".")[2] in GREATER_IS_FINER:
        return value
    return 1 / value if value else math.inf


def _alike(point: Measured, settings: Mapping[str, Any]) -> bool:
    return all(setting(settings, path) == name for path, name in point.names.items())
