"""The whole animation as a file for other programs: USD, Alembic, or a .blend that holds all it needs."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from typing import Any

from render.blender.engine import configure
from render.blender.session import bpy, check, release, silenced
from render.content.motion import show_only
from render.content.scene import Scene, plain
from render.errors import RenderError, Unusable
from render.inputs import Inputs
from render.job import Job, Report


def export_film(job: Job, path: Path, report: Report) -> dict[str, Any]:
    """Write a job's frames to a file; returns the summary.

    Raises RenderError, and Unusable for files that cannot be read and formats that this Blender does not write.
    """
    part = path.with_name(f".{path.stem}.part{path.suffix}")
    inputs = Inputs(Path(job.simulation), Path(job.surface) if job.surface else None)
    # these cost what a picture takes: whoever opens the file chooses whether to have them
    settings = plain(job.settings | {"caustics": False})
    try:
        with silenced(Path(job.log)):
            bpy.ops.wm.read_factory_settings(use_empty=True)
            configure(settings, job.threads, job.fps)
            scene = Scene(settings, inputs, job.fps)
            bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"
            stage = bpy.context.scene
            stage.frame_start, stage.frame_end = job.first, job.last
            poses = inputs.poses(job.frames())
            for frame in job.frames():
                scene.key(frame, poses[frame])
            write = _write_blend if path.suffix == ".blend" else _write_geometry
            write(scene, job, part, report)
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


def _write_geometry(scene: Scene, job: Job, path: Path, report: Report) -> None:
    """Exporters ask for one frame after another. They take a mesh for still whose object has no modifier (that of
    triangles to triangles changes nothing), and one of another name for another thing. What is raised while they ask
    Blender prints, and goes on with the meshes of the frame before."""
    failed: list[Exception] = []

    def bring(stage: Any, *_: Any) -> None:
        frame = stage.frame_current
        if frame not in job.frames() or failed:
            return
        try:
            place(frame)
        except Exception as error:
            failed.append(error)

    def place(frame: int) -> None:
        for name, mesh in scene.read(frame).items():
            moving = scene.moving()[name]
            if mesh is None or len(mesh.triangles) == 0:
                moving.take(_nothing(name), None)
            else:
                moving.take(moving.build(mesh, name), mesh)
            moving.thing.data.name = name
        report({"frame": frame, "wall_s": 0.0})

    for moving in scene.moving().values():
        moving.thing.modifiers.new("sampled", "TRIANGULATE")
    bpy.app.handlers.frame_change_pre.append(bring)
    if path.suffix == ".abc":
        frames = {"start": job.first, "end": job.last}
        _write(path, bpy.ops.wm.alembic_export, evaluation_mode="RENDER", as_background_job=False, **frames)
    else:
        _write(path, bpy.ops.wm.usd_export, evaluation_mode="RENDER", export_animation=True)
    if failed:
        raise failed[0]


def _write(path: Path, operator: Any, **options: Any) -> None:
    """Let an operator of Blender write a file; raises Unusable where it cannot, or is not there."""
    try:
        check(operator(filepath=str(path), **options), "exporting")
    except (AttributeError, RuntimeError) as error:
        raise Unusable(f"this Blender cannot write {path.suffix} files: {error}") from error


def _nothing(name: str) -> Any:
    """A triangle without area: exporters go on with the last mesh where one is empty."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0.0, 0.0, 0.0)] * 3, [], [(0, 1, 2)])
    return mesh


def _write_blend(scene: Scene, job: Job, path: Path, report: Report) -> None:
    """What changes its shape is one object a frame, in sight in that frame alone: it needs no files and no scripts."""
    for moving in scene.moving().values():
        bpy.data.objects.remove(moving.thing)
    for frame in job.frames():
        for name, mesh in scene.read(frame).items():
            if mesh is None or len(mesh.triangles) == 0:
                continue
            thing = scene.moving()[name].copy(mesh, f"{name}_{frame:05d}")
            for when, seen in ((frame - 1, False), (frame, True), (frame + 1, False)):
                show_only(thing, seen, when)
        report({"frame": frame, "wall_s": 0.0})
    for image in bpy.data.images:
        if image.source == "FILE" and image.packed_file is None:
            image.pack()
    bpy.context.scene.frame_set(job.first)
    _write(path, bpy.ops.wm.save_as_mainfile, copy=True, compress=True)
