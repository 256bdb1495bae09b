"""The studies of the project by name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from scene.document import SceneError
from workflow.plan.jobs import Job
from workflow.plan.lookup import JobLookup, stop
from workflow.plan.shelf import STUDY_FILES
from workflow.study.load import load_study
from workflow.study.plan import StudyPlan


class Studies(JobLookup):
    """Plans of the studies, each made once."""

    def __init__(self, root: Path, dry: Callable[[], bool] = lambda: True):
        super().__init__(dry)
        self._root = root
        self._plans: dict[str, StudyPlan] = {}

    def plan(self, name: str) -> StudyPlan:
        """The plan of a study; ends the process with a message where the study cannot be used."""
        if name not in self._plans:
            try:
                self._plans[name] = StudyPlan(load_study(STUDY_FILES.find(name), name), self._root)
            except SceneError as error:
                stop(str(error))
        return self._plans[name]

    def find(self, stage: str, wildcards: Any) -> Job:
        """Wildcards: study, and of a trial its name and the number of the repeat."""
        plan = self.plan(wildcards.study)
        if stage == "study":
            return plan.report
        try:
            return plan.trial(wildcards.trial, int(wildcards.repeat))
        except (KeyError, IndexError):
            stop(f"study {wildcards.study} has no trial {wildcards.trial}, repeat {wildcards.repeat}")
