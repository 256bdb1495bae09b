"""What runs within an installed Blender: its Python brings bpy and the standard library, little else."""

from __future__ import annotations

import json
import sys
import time
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_file_location
from pathlib import Path
from typing import Any

MARK = "tidemill-render: "
"""Begins the lines on the standard output that are meant for `installed`; the rest is Blender's own."""
FAILED = 3
"""Exit code when Python fails within Blender."""


class Packages(MetaPathFinder):
    """Finds packages by their files, and nothing else of where these are installed."""

    def __init__(self, files: dict[str, str]):
        self._files = files

    def find_spec(self, fullname: str, path: Any, target: Any = None) -> ModuleSpec | None:
        """Of a package that is known; None for all others."""
        file = self._files.get(fullname)
        return spec_from_file_location(fullname, file) if file else None


def main(job_file: str) -> None:
    """Render the job of a file and report on the standard output."""
    start = time.perf_counter()
    from render.errors import RenderError, Unusable

    try:
        from render.blender.work import carry_out
        from render.job import Job

        imported = time.perf_counter() - start
        job = Job.load(Path(job_file))
        sys.meta_path.append(Packages(job.packages))
        summary = carry_out(job, _report)
        summary["wall_s"] = {"import": imported, **summary["wall_s"]}
        _report({"summary": summary})
    except RenderError as error:
        _report({"error": str(error), "refused": isinstance(error, Unusable)})


def _report(event: dict[str, Any]) -> None:
    print(MARK + json.dumps(event), flush=True)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    main(sys.argv[sys.argv.index("--") + 1])
