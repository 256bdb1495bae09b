"""What is there already: is a result complete, and does Snakemake know what it was made with?

Only reads; a dry-run changes nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from common import manifest
from workflow.plan import record
from workflow.plan.jobs import Job

_REPAIRS = re.compile(r"'repairs (\d+)'")


class Unrecorded(Exception):
    """A result that is not what the scene asks for, while Snakemake would take it as up to date."""


def repairs(job: Job, *, complete: bool = True) -> str:
    """A value that differs from the recorded one exactly while the result is damaged.

    It counts how often the result was repaired: the next number while something is missing from
    the folder, or `complete` is false; otherwise the number that Snakemake recorded.
    """
    recorded = record.params(job.folder) or []
    count = next((int(match[1]) for value in recorded if (match := _REPAIRS.fullmatch(value))), 0)
    folder = Path(job.folder)
    damaged = folder.is_dir() and (not complete or bool(manifest.damage(folder)))
    return f"repairs {count + damaged}"


def refuse_unrecorded(jobs: Iterable[Job]) -> None:
    """Raise Unrecorded for results without a record that are not what is asked for.

    Snakemake compares nothing where its record is missing: an edit would go unnoticed.
    """
    wrong = []
    for job in jobs:
        folder = Path(job.folder)
        if not folder.is_dir() or record.params(job.folder) is not None or record.is_incomplete(job.folder):
            continue
        found = manifest.Manifest.read(folder)
        if found is None or found.plan != job.plan or found.damage(folder):
            wrong.append(job.folder)
    if wrong:
        names = "\n".join(f"  {folder}" for folder in wrong)
        raise Unrecorded(
            f"Snakemake's record of these results is missing (.snakemake/metadata), and they are not\n"
            f"what the scene asks for now, so they would be kept although they are out of date:\n{names}\n"
            f"  fix: remove them, with rm -r {' '.join(wrong)}"
        )
