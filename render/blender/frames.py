"""The loop over a block of frames, within Blender."""

from __future__ import annotations

import platform
import resource
import time
from pathlib import Path
from typing import Any

from common.stopwatch import Stopwatch
from render.blender.engine import configure
from render.blender.pictures import passes_beside, save_picture
from render.blender.session import bpy, check, release, silenced
from render.content.scene import Scene, plain
from render.errors import RenderError
from render.inputs import Inputs
from render.job import Job, Report


def render_frames(job: Job, report: Report) -> dict[str, Any]:
    """Render a job's frames; returns the summary.

    Raises RenderError, and Unusable for settings or files that cannot be rendered.
    """
    log, watch = Path(job.log), Stopwatch()
    settings = plain(job.settings)
    folders = (Path(folder) if folder else None for folder in (job.surface, job.foam, job.wet))
    inputs = Inputs(Path(job.simulation), *folders)
    seconds: list[float] = []
    without_water: list[int] = []
    try:
        with silenced(log), watch.phase("build"):
            bpy.ops.wm.read_factory_settings(use_empty=True)
            device, warnings = configure(settings, job.threads, job.fps)
            scene = Scene(settings, inputs, job.fps)
        with watch.phase("load"):
            poses = inputs.poses(job.frames())
        for frame in job.frames():
            start = time.perf_counter()
            with silenced(log):
                with watch.phase("load"):
                    meshes = scene.read(frame)
                with watch.phase("build"):
                    scene.show(frame, poses[frame], meshes)
                if job.save_blend and frame == job.first:
                    _save_blend(Path(job.save_blend))
                passes = Path(job.out) / f"{frame:05d}.exr"
                with watch.phase("render"), passes_beside(passes, bool(settings.passes)):
                    _render(to_file=bool(settings.passes))
                with watch.phase("write"):
                    save_picture(Path(job.out) / f"{frame:05d}.png")
            water = meshes.get("water")
            if water is not None and len(water.triangles) == 0:
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
        "wall_s": watch.seconds,
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
        if image.packed_file is None and (image.source == "FILE" or image.is_dirty):
            image.pack()
    try:
        check(bpy.ops.wm.save_as_mainfile(filepath=str(path.resolve()), copy=True, compress=True), "saving the scene")
    except RuntimeError as error:
        raise RenderError(f"cannot write {path}: {error}") from error
