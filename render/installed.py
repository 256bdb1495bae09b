"""Rendering in an installed Blender, as a process of its own."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

from render.errors import RenderError, Unusable
from render.inside import FAILED, MARK
from render.job import Job, Report


def render_installed(blender: str, job: Job, scratch: Path, report: Report) -> dict[str, Any]:
    """Render a job's frames with the Blender at a path; returns the summary.

    Raises Unusable when the path is no Blender, RenderError when Blender fails.
    """
    job_file = scratch / "job.json"
    job.write(job_file)
    inside = Path(__file__).with_name("inside.py")
    command = [blender, "-b", "--factory-startup", "--python-exit-code", str(FAILED), "--python", str(inside)]
    summary: dict[str, Any] | None = None
    try:
        process = subprocess.Popen(
            [*command, "--", str(job_file)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
    except OSError as error:
        raise Unusable(f"blender: can not start {blender}: {error.strerror}") from error
    with process, Path(job.log).open("a") as log:
        for line in process.stdout:
            mark, _, message = line.partition(MARK)
            if mark or not message:
                log.write(line)
                continue
            event = json.loads(message)
            if "error" in event:
                process.wait()
                raise (Unusable if event["refused"] else RenderError)(event["error"])
            if "summary" in event:
                summary = event["summary"]
            else:
                report(event)
    if process.returncode != 0 or summary is None:
        raise RenderError(f"blender: {blender} ended with exit code {process.returncode}")
    return summary
