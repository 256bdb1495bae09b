"""What each job of a study depends on: pure functions of the study, its scene and of the source files."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

from common.frames import Frames
from scene.load import Scene
from scene.settings import canonical_json
from workflow.plan.jobs import ENTRY, RESULTS, Job, Plan, sources, versions
from workflow.plan.shelf import STUDIES
from workflow.plan.specs import spec_file
from workflow.study.load import LoadedStudy, Trial
from workflow.study.spec import ByTable
from workflow.study.trial import RUN

REPORT = "workflow.study"
TRIAL = "workflow.study.trial"
PACKAGES = ("matplotlib", "numpy", "pillow", "scipy", "simpleeval", "trimesh")
"""Those that measure and draw."""


class StudyPlan:
    """The jobs of one study. `root` is the folder of the packages sim, render and workflow."""

    def __init__(self, loaded: LoadedStudy, root: Path):
        self.loaded = loaded
        self.study = loaded.study
        self._root = root
        self._trials = {trial.name: trial for trial in [*loaded.trials, *([loaded.truth] if loaded.truth else [])]}
        self._plans: dict[str, Plan] = {}
        self._jobs: dict[str, Job] = {}

    def scene(self, name: str) -> Scene:
        """The scene at a trial's settings; raises KeyError."""
        return self._trials[name].scene

    def trial(self, name: str, repeat: int) -> Job:
        """The job of one trial; raises KeyError where the study has none of that name, IndexError for the repeat."""
        trial = self._trials[name]
        if not 0 <= repeat < self._repeats(trial):
            raise IndexError(f"there is no repeat {repeat} of {self._repeats(trial)}")
        folder = f"{RESULTS}/{STUDIES}/{self.loaded.name}/{name}/{repeat}"
        return replace(self._of_all_repeats(name), folder=folder)

    def trials(self) -> list[Job]:
        """The jobs of all trials, each as often as it is repeated."""
        return [self.trial(name, k) for name, trial in self._trials.items() for k in range(self._repeats(trial))]

    def inputs(self, name: str) -> dict[str, str]:
        """Folders that a trial's command reads, by its options: results of the film of the scene."""
        plan = self._plan(name)
        segment = self._segment(plan)
        found = {}
        if self.study.stage != "simulate":
            found["--simulation"] = plan.job("simulate", segment).folder
        if self.study.stage == "render" and plan.has_surface:
            found["--surface"] = plan.job("reconstruct", segment).folder
        if self.study.stage == "render" and plan.has_foam:
            found["--foam"] = plan.job("foam", segment).folder
        if self.study.stage == "render" and plan.has_wetness:
            found["--wet"] = plan.job("wet", segment).folder
        return found

    def command(self, name: str) -> list[str]:
        """The module that a trial runs, and its arguments."""
        scene, job = self._trials[name].scene, self._stage_job(name)
        words = [ENTRY[self.study.stage], "--spec", spec_file(job.spec), "--out", RUN]
        words += ["--frames", str(self._frames(scene)), "--threads", str(self.study.threads)]
        words += [word for option in self.inputs(name).items() for word in option]
        if self.study.stage == "simulate":
            words += ["--folder", str(scene.folder)]
        if self.study.stage == "render":
            words += ["--fps", f"{scene.simulation.fps:.17g}"]
        return words

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

    def _plan(self, name: str) -> Plan:
        if name not in self._plans:
            self._plans[name] = Plan(self._trials[name].scene, self._root)
        return self._plans[name]

    def _of_all_repeats(self, name: str) -> Job:
        if name not in self._jobs:
            job = self._stage_job(name)
            code = hashlib.sha256(f"{job.code} {self._trial_code}".encode()).hexdigest()
            frames = self._frames(self._trials[name].scene)
            self._jobs[name] = replace(job, stage="trial", frames=frames, code=f"code {code[:32]}")
        return self._jobs[name]

    def _stage_job(self, name: str) -> Job:
        """The job of the film that does what a trial measures."""
        plan = self._plan(name)
        if self.study.stage == "simulate":
            return plan.whole_simulation()
        if self.study.stage == "reconstruct":
            return plan.job("reconstruct", self._segment(plan))
        block = next(k for k in range(plan.timeline.blocks) if self._frame(plan.scene) <= plan.timeline.block(k).last)
        return plan.job("render", block)

    def _segment(self, plan: Plan) -> int:
        frame, timeline = self._frame(plan.scene), plan.timeline
        return next(k for k in range(timeline.segments) if frame <= timeline.segment(k).last)

    def _frame(self, scene: Scene) -> int:
        return scene.last_frame if self.study.frame is None else self.study.frame

    def _frames(self, scene: Scene) -> Frames:
        last = self._frame(scene)
        return Frames(0 if self.study.stage == "simulate" else last, last)

    @cached_property
    def _trial_code(self) -> str:
        return sources.digest(TRIAL, self._root, frozenset())

    def _repeats(self, trial: Trial) -> int:
        """The reference needs no time, so that it is carried out once."""
        return 1 if trial is self.loaded.truth else self.study.repeats

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
