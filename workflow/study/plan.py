"""What each job of a study depends on: pure functions of the study, its scene and of the source files."""

from __future__ import annotations

import json
from functools import cached_property
from pathlib import Path
from typing import Any

from sim.settings import canonical_json
from workflow import sources
from workflow.catalog import STUDIES
from workflow.plan import RESULTS, Job, Plan, versions
from workflow.scene import Scene
from workflow.study.load import LoadedStudy, Trial
from workflow.study.spec import ByTable
from workflow.timeline import Frames

REPORT = "workflow.study"
PACKAGES = ("matplotlib", "numpy", "scipy")
"""Those that measure and draw."""


class StudyPlan:
    """The jobs of one study. `root` is the folder of the packages sim, render and workflow."""

    def __init__(self, loaded: LoadedStudy, root: Path):
        self.loaded = loaded
        self.study = loaded.study
        self._root = root
        self._trials = {trial.name: trial for trial in [*loaded.trials, *([loaded.truth] if loaded.truth else [])]}
        self._plans: dict[str, Plan] = {}

    def scene(self, name: str) -> Scene:
        """The scene at a trial's settings; raises KeyError."""
        return self._trials[name].scene

    def trial(self, name: str, repeat: int) -> Job:
        """The job of one trial; raises KeyError where the study has none of that name, IndexError for the repeat."""
        trial = self._trials[name]
        if not 0 <= repeat < self._repeats(trial):
            raise IndexError(f"there is no repeat {repeat} of {self._repeats(trial)}")
        if name not in self._plans:
            self._plans[name] = Plan(trial.scene, self._root)
        return self._plans[name].trial(f"{RESULTS}/{STUDIES}/{self.loaded.name}/{name}/{repeat}")

    def _repeats(self, trial: Trial) -> int:
        """The reference needs no time, so that it is simulated once."""
        return 1 if trial is self.loaded.truth else self.study.repeats

    def trials(self) -> list[Job]:
        return [self.trial(name, k) for name, trial in self._trials.items() for k in range(self._repeats(trial))]

    @cached_property
    def report(self) -> Job:
        """The job that makes table and plots."""
        return Job(
            stage="study",
            folder=f"{STUDIES}/{self.loaded.name}",
            frames=Frames(0, 0),
            spec=json.dumps(self._spec()),
            code=f"code {sources.digest(REPORT, self._root, frozenset())[:32]}",
            versions=versions(*PACKAGES),
            assets=f"assets {canonical_json(self._assets())}",
            upstream=tuple(job.plan for job in self.trials()),
        )

    def _spec(self) -> dict[str, Any]:
        """What the report needs to know, besides the trials' results; in the order of the file, as the legend is."""
        return {
            "name": self.loaded.name,
            "study": self.study.model_dump(mode="json", exclude_none=True),
            "trials": [[trial.name, trial.chosen] for trial in self.loaded.trials],
            "truth": self.loaded.truth.name if self.loaded.truth else None,
        }

    def _assets(self) -> dict[str, str]:
        reference = self.study.reference
        if not isinstance(reference, ByTable):
            return {}
        return {reference.file: (self.loaded.path.parent / reference.file).read_text(encoding="utf-8")}
