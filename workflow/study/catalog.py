"""The studies of the project by name: `scenes/studies/column.yaml` is `column`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sim.similar import similar
from workflow.catalog import SCENES, STUDIES
from workflow.document import SceneError
from workflow.lookup import JobLookup, stop
from workflow.plan import Job
from workflow.study.load import load_study
from workflow.study.plan import StudyPlan


def names(folder: Path = Path(SCENES, STUDIES)) -> list[str]:
    """Names of all studies, sorted."""
    return sorted(path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.yaml"))


class Studies(JobLookup):
    """Plans of the studies, each made once."""

    def __init__(self, root: Path):
        super().__init__()
        self._root = root
        self._plans: dict[str, StudyPlan] = {}

    def plan(self, name: str) -> StudyPlan:
        if name not in self._plans:
            known = names()
            if name not in known:
                near = " or ".join(f"{STUDIES}/{other}" for other in similar(name, known, most=3))
                fix = f"did you mean {near}?" if near else f"the studies are {', '.join(known) or 'none yet'}"
                stop(f"there is no study '{name}': no file {SCENES}/{STUDIES}/{name}.yaml\n  fix: {fix}")
            try:
                self._plans[name] = StudyPlan(load_study(Path(SCENES, STUDIES, f"{name}.yaml"), name), self._root)
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
