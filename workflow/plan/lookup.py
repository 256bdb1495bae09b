"""What the rules ask for: fields of the job that their wildcards mean."""

from __future__ import annotations

import inspect
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, NoReturn, TypeVar

from workflow.plan.jobs import Job
from workflow.plan.results import Unrecorded, refuse_unrecorded, repairs
from workflow.plan.specs import spec_file, write_spec

Function = TypeVar("Function", bound=Callable)


def with_signature(function: Function) -> Function:
    """The function, for a rule: Snakemake looks for its parameters several times a job, which takes longer than to call
    it unless it has them ready."""
    function.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]  # of any callable
    return function


class JobLookup(ABC):
    """Jobs by the wildcards of a rule; every failure ends the process with its message."""

    def __init__(self, dry: Callable[[], bool]) -> None:
        """`dry` tells whether jobs are only planned, so that nothing is written."""
        self._dry = dry
        self._checked: set[str] = set()

    @abstractmethod
    def find(self, stage: str, wildcards: Any) -> Job:
        """The job of a stage that a rule's wildcards mean."""

    def complete(self, job: Job, wildcards: Any) -> bool:
        """Whether what the job makes outside of its folder is there."""
        return True

    def job(self, stage: str, wildcards: Any) -> Job:
        """`find`, for jobs whose results Snakemake knows."""
        job = self.find(stage, wildcards)
        if job.folder not in self._checked:
            try:
                refuse_unrecorded([job])
            except Unrecorded as error:
                stop(str(error))
            self._checked.add(job.folder)
        return job

    def of(self, stage: str) -> Callable[..., Callable[[Any], Any]]:
        """`of("render")("spec")` is a function of the wildcards, as rules take it."""

        def field(name: str) -> Callable[[Any], str]:
            return with_signature(lambda wildcards: str(getattr(self.job(stage, wildcards), name)))

        return field

    def spec(self, stage: str) -> Callable[[Any], str]:
        """A function of the wildcards: the file with the job's settings, which is written if jobs are carried out."""

        def file(wildcards: Any) -> str:
            spec = self.job(stage, wildcards).spec
            try:
                return spec_file(spec) if self._dry() else write_spec(spec)
            except OSError as error:
                stop(f"{error.filename}: cannot be written: {error.strerror}")

        return with_signature(file)

    def repairs(self, stage: str) -> Callable[[Any], str]:
        """A function of the wildcards: a value that changes while the result is damaged."""

        def count(wildcards: Any) -> str:
            job = self.job(stage, wildcards)
            return repairs(job, complete=self.complete(job, wildcards))

        return with_signature(count)


def stop(message: str) -> NoReturn:
    """End the process with a message and without a traceback."""
    print(f"tidemill: {message}", file=sys.stderr, flush=True)
    raise SystemExit(1)
