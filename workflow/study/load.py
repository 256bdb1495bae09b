"""One study file: load it, and load its scene at every trial's settings."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scene import assets, grid
from scene.diagnostics.problems import validated
from scene.document import Document, SceneError
from scene.load import Scene, load
from scene.reader import read
from scene.settings import Refused, canonical_json
from workflow.study import formula, measure
from workflow.study.spec import ByTrial, Overrides, Study

MOST_TRIALS = 2000


@dataclass(frozen=True)
class Trial:
    """One combination of settings; `chosen` are those of the grid."""

    chosen: Overrides
    overrides: tuple[str, ...]
    scene: Scene

    @property
    def name(self) -> str:
        """Eight hexadecimal digits that stay while other values join the grids."""
        return hashlib.sha256(canonical_json(list(self.overrides)).encode()).hexdigest()[:8]


@dataclass(frozen=True)
class LoadedStudy:
    """A valid study with its trials; `truth` is the one that all are compared with, where the reference is a trial."""

    name: str
    path: Path
    study: Study
    trials: tuple[Trial, ...]
    truth: Trial | None


def load_study(path: Path, name: str) -> LoadedStudy:
    """Load a study; raises SceneError, whose text names file, line, field and remedy of every problem."""
    document = read(path)
    study = validated(document, Study)
    try:
        _check(study, path.parent)
        trials = {trial.name: trial for trial in _trials(study, path.parent, document)}
        truth = None
        if isinstance(study.reference, ByTrial):
            truth = _trial(study, path.parent, study.reference.set, document, ("reference", "set"))
    except Refused as refused:
        raise SceneError([document.problem(refused.location, refused.message, refused.remedy)]) from None
    return LoadedStudy(name, path, study, tuple(trials.values()), truth)


def _check(study: Study, folder: Path) -> None:
    """Refuse what would be found out only after hours, and files that lie where scenes may not read."""
    for location, file in study.files():
        try:
            assets.within_reach(file, folder)
        except Refused as refused:
            raise refused.at(*location) from None
    if not isinstance(study.reference, ByTrial):
        measure.truth(study.reference, study.quantity, study.scale, folder)
    elif study.scale is not None:
        formula.evaluate(study.scale)
    grid.refuse_more(MOST_TRIALS, study.grids, "trials", ("grids",))


def _trials(study: Study, folder: Path, document: Document) -> Iterator[Trial]:
    for index, values in enumerate(study.grids):
        for chosen in grid.combinations(values):
            yield _trial(study, folder, chosen, document, ("grids", index))


def _trial(study: Study, folder: Path, chosen: Mapping[str, Any], document: Document, location: tuple) -> Trial:
    overrides = grid.overrides({**study.set, **chosen})
    try:
        scene = load(Path(os.path.normpath(folder / study.scene)), quality=study.quality, overrides=overrides)
    except SceneError as error:
        mark = document.mark(location)
        raise SceneError([f"{mark.source}:{mark.line}: {problem}" for problem in error.problems]) from None
    if study.frame is not None and study.frame > scene.last_frame:
        raise Refused(
            f"{study.scene} has no frame {study.frame}", location=("frame",), remedy=f"at most {scene.last_frame}"
        )
    if study.stage == "reconstruct" and scene.simulation.fluid is None:
        raise Refused(
            f"{study.scene} has no fluid, so no surface", location=("scene",), remedy="name a scene with a fluid"
        )
    return Trial(dict(chosen), overrides, scene)
