"""What the sheet and the table of a wedge depend on."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from common.frames import Frames
from scene.wedge import Combination
from workflow.plan.jobs import Job, Plan, sources, versions

WEDGES = "wedges"
REPORT = "workflow.wedge"


def wedge_job(name: str, films: Mapping[str, tuple[Combination, Plan]], root: Path) -> Job:
    """The job of a scene's wedge; `films`: its combinations with the plans of their films, by the films' names."""
    jobs = {film: (combination, plan.job("film")) for film, (combination, plan) in films.items()}
    spec = {
        "name": name,
        "films": [
            {"name": film, "folder": job.folder, "chosen": combination.chosen}
            for film, (combination, job) in jobs.items()
        ],
    }
    return Job(
        stage="wedge",
        folder=f"{WEDGES}/{name}",
        frames=Frames(0, 0),
        spec=json.dumps(spec),
        code=f"code {sources.digest(REPORT, root, frozenset())[:32]}",
        versions=versions("pillow"),
        assets="assets {}",
        upstream=tuple(job.plan for _, job in jobs.values()),
    )
