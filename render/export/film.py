"""The whole animation as a file for other programs."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from pathlib import Path
from typing import Any

from render.blender.engine import configure
from render.blender.session import bpy, release, silenced
from render.content.scene import Scene, plain
from render.errors import RenderError
from render.export.blend import write_blend
from render.export.clouds import clouds_of
from render.export.frames import Frames
from render.export.gltf import write_gltf
from render.export.sampled import write_alembic, write_usd
from render.inputs import Inputs
from render.job import Job, Report
from render.looks.simple import Known

Write = Callable[[Frames, Path], None]
FORMATS: dict[str, tuple[Write, Known]] = {
    **dict.fromkeys((".usd", ".usda", ".usdc"), (write_usd, "opacity")),
    ".abc": (write_alembic, "opacity"),
    ".glb": (write_gltf, "transmission"),
    ".blend": (write_blend, "all"),
}
"""What writes a format, and what this knows of clear things."""


def export_film(job: Job, path: Path, report: Report) -> dict[str, Any]:
    """Write a job's frames to a file; returns the summary.

    Raises RenderError, and Unusable for files that cannot be read and formats that this Blender does not write.
    """
    write, known = FORMATS[path.suffix]
    part = path.with_name(f".{path.stem}.part{path.suffix}")
    inputs = Inputs(Path(job.simulation), *(Path(folder) if folder else None for folder in (job.surface, job.foam)))
    # these cost what a picture takes: whoever opens the file chooses whether to have them
    settings = plain(job.settings | {"caustics": False})
    try:
        with silenced(Path(job.log)):
            bpy.ops.wm.read_factory_settings(use_empty=True)
            configure(settings, job.threads, job.fps)
            scene = Scene(settings, inputs, job.fps, known)
            bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"
            stage = bpy.context.scene
            stage.frame_start, stage.frame_end = job.first, job.last
            frames = Frames(scene, job.frames(), job.fps, inputs.poses(job.frames()), clouds_of(scene, job), report)
            write(frames, part)
        part.replace(path)
    except OSError as error:
        raise RenderError(f"cannot write {path}: {error.strerror}") from error
    finally:
        release()
        part.unlink(missing_ok=True)
    return {
        "versions": {"blender": bpy.app.version_string, "python": platform.python_version()},
        "frames": {"first": job.first, "last": job.last, "count": len(job.frames())},
        "bytes": os.path.getsize(path),
        "warnings": [],
        "wall_s": {},
    }
