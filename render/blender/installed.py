"""Rendering in an installed Blender, as a process of its own."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import IO, Any

from render.blender.inside import FAILED, MARK
from render.errors import RenderError, Unusable
from render.job import Job, Report


def render_installed(blender: str, job: Job, scratch: Path, report: Report) -> dict[str, Any]:
    """Render a job's frames with the Blender at a path; returns the summary.

    Raises Unusable when it cannot be started, RenderError when it fails.
    """
    job_file = scratch / "job.json"
    job.write(job_file)
    inside = Path(__file__).with_name("inside.py")
    command = [blender, "-b", "--factory-startup", "--python-exit-code", str(FAILED), "--python", str(inside)]
    command += ["--", str(job_file)]
    try:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    except OSError as error:
        raise Unusable(f"blender: cannot start {blender}: {error.strerror}") from error
    with process, Path(job.log).open("a") as log:
        try:
            summary = _follow(process.stdout or (), log, report)
        except BaseException:
            process.kill()
            raise
    if process.returncode != 0 or summary is None:
        raise RenderError(f"blender: {blender} ended with exit code {process.returncode}")
    return summary


def _follow(output: Iterable[str], log: IO[str], report: Report) -> dict[str, Any] | None:
    """Pass on what `inside` reports, and keep what Blender prints; returns the summary, if it came to that."""
    summary = None
    for line in output:
        if not line.startswith(MARK):
            log.write(line)
            continue
        event = json.loads(line.removeprefix(MARK))
        if "error" in event:
            raise (Unusable if event["refused"] else RenderError)(event["error"])
        if "summary" in event:
            summary = event["summary"]
        else:
            report(event)
    return summary
