"""What runs within an installed Blender: its Python brings bpy and the standard library, little else."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

MARK = "tidemill-render: "
"""Begins the lines on the standard output that are meant for `installed`; the rest is Blender's own."""
FAILED = 3
"""Exit code when Python fails within Blender."""


def main(job_file: str) -> None:
    """Render the job of a file and report on the standard output."""
    start = time.perf_counter()
    from render.errors import RenderError, Unusable

    try:
        from render.blender.work import carry_out
        from render.job import Job

        imported = time.perf_counter() - start
        summary = carry_out(Job.load(Path(job_file)), _report)
        summary["wall_s"] = {"import": imported, **summary["wall_s"]}
        _report({"summary": summary})
    except RenderError as error:
        _report({"error": str(error), "refused": isinstance(error, Unusable)})


def _report(event: dict[str, Any]) -> None:
    print(MARK + json.dumps(event), flush=True)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    main(sys.argv[sys.argv.index("--") + 1])
