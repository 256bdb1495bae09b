"""A .blend: what changes its shape is one object a frame, in sight in that frame alone. It needs no files and no
scripts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from render.blender.session import bpy
from render.content.changing.foam import Foam
from render.content.motion import show_only
from render.export.frames import Frames, save


def write_blend(frames: Frames, path: Path) -> None:
    """Write the frames with everything that Blender needs to render them."""
    frames.key()
    scene = frames.scene
    for thing in scene.sampled():
        bpy.data.objects.remove(thing)
    balls = {cloud.name: Foam(cloud.material, meshes=False) for cloud in frames.clouds}
    for ball in balls.values():
        bpy.data.objects.remove(ball.thing)
    for frame in frames.numbers:
        for name, mesh in scene.read_meshes(frame).items():
            if mesh is not None and len(mesh.triangles) > 0:
                _show(scene.moving()[name].copy(mesh, f"{name}_{frame:05d}"), frame)
        for cloud in frames.clouds:
            points = cloud.read(frame)
            if points.vertex_count() > 0:
                _show(balls[cloud.name].add(f"{cloud.name}_{frame:05d}", cloud.build(cloud.name, points)), frame)
        frames.done(frame)
    for image in bpy.data.images:
        if image.source == "FILE" and image.packed_file is None:
            image.pack()
    bpy.context.scene.frame_set(frames.numbers[0])
    save(path, bpy.ops.wm.save_as_mainfile, copy=True, compress=True)


def _show(thing: Any, frame: int) -> None:
    for when, seen in ((frame - 1, False), (frame, True), (frame + 1, False)):
        show_only(thing, seen, when)
