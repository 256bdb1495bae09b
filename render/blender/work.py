"""What a job is: pictures, or one file of the animation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from render.job import Job, Report


def carry_out(job: Job, report: Report) -> dict[str, Any]:
    """Do a job within Blender; returns the summary. Raises RenderError, and Unusable."""
    if job.export is not None and job.export.endswith(".vdb"):
        from render.export.volumes import export_volumes

        return export_volumes(job, Path(job.export), report)
    if job.export is not None:
        from render.export.film import export_film

        return export_film(job, Path(job.export), report)
    from render.blender.frames import render_frames

    return render_frames(job, report)
