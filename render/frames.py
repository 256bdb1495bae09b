"""The loop over a block of frames, within Blender."""

from __future__ import annotations

import contextlib
import platform
import resource
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from render.blender import bpy, check, release, silenced
from render.engine import configure
from render.errors import RenderError
from render.inputs import Inputs
from render.job import Job, Report
from render.pictures import passes_beside, save_picture
from render.scene import Scene, plain


class Clock:
    """Wall time [s] by phase."""

    def __init__(self) -> None:
        self.wall_s: dict[str, float] = {}

    @contextlib.contextmanager
    def phase(self, name: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.wall_s[name] = self.wall_s.get(name, 0.0) + time.perf_counter() - start


def render_frames(job: Job, report: Report) -> dict[str, Any]:
    """Render a job's frames; returns the summary.

    Raises RenderError, and Unusable for settings or files that can not be rendered.
    """
    log, clock = Path(job.log), Clock()
    settings = plain(job.settings)
    inputs = Inputs(*(Path(folder) if folder else None for folder in (job.simulation, job.surface, job.foam)))
    seconds: list[float] = []
    without_water: list[int] = []
    try:
        with silenced(log), clock.phase("build"):
            bpy.ops.wm.read_factory_settings(use_empty=True)
            scene = Scene(settings, inputs, job.fps)
            device, warnings = configure(settings, job.threads, job.fps)
        with clock.phase("load"):
            poses = inputs.poses(job.frames())
        for frame in job.frames():
            start = time.perf_counter()
            with silenced(log):
                with clock.phase("load"):
                    meshes = scene.read(frame)
                with clock.phase("build"):
                    scene.show(frame, poses[frame], meshes)
                if job.save_blend and frame == job.first:
                    _save_blend(Path(job.save_blend))
                passes = Path(job.out) / f"{frame:05d}.exr"
                with clock.phase("render"), passes_beside(passes, bool(settings.passes)):
                    _render(to_file=bool(settings.passes))
                with clock.phase("write"):
                    save_picture(Path(job.out) / f"{frame:05d}.png")
            if meshes.get("water") is not None and len(meshes["water"].triangles) == 0:
                without_water.append(frame)
            seconds.append(time.perf_counter() - start)
            report({"frame": frame, "wall_s": seconds[-1]})
    finally:
        release()
    return {
        "versions": {"blender": bpy.app.version_string, "python": platform.python_version()},
        "frames": {"first": job.first, "last": job.last, "count": len(seconds), "without_water": without_water},
        "resolution": list(settings.resolution),
        "device": {"kind": device.kind, "names": list(device.names)},
        "threads": bpy.context.scene.render.threads,
        "warnings": warnings,
        "wall_s": clock.wall_s,
        "wall_s_per_frame": seconds,
        "peak_memory_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
    }


def _render(to_file: bool) -> None:
    try:
        check(bpy.ops.render.render(write_still=to_file), "rendering")
    except RuntimeError as error:
        raise RenderError(f"Blender could not render: {error}") from error


def _save_blend(path: Path) -> None:
    for image in bpy.data.images:
        if image.source == "FILE":
            image.pack()
    try:
        check(bpy.ops.wm.save_as_mainfile(filepath=str(path.resolve()), copy=True, compress=True), "saving the scene")
    except RuntimeError as error:
        raise RenderError(f"can not write {path}: {error}") from error
