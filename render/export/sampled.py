"""USD and Alembic: Blender's exporters ask for one frame after another.

They take a mesh for still whose object has no modifier (that of triangles to triangles changes nothing), and one of
another name for another thing. What is raised while they ask Blender prints, and goes on with the meshes of the frame
before.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from common.attributes import attributes_among
from render.blender.session import bpy
from render.content.ply import TriangleMesh
from render.export.clouds import Cloud
from render.export.frames import Frames, save
from render.export.points import Particles, PointClouds, Points


def write_usd(frames: Frames, path: Path) -> None:
    """Write the frames with y up, as scenes have it, unless this Blender is too old for that."""
    _write(
        frames,
        PointClouds,
        lambda: save(
            path,
            bpy.ops.wm.usd_export,
            evaluation_mode="RENDER",
            export_animation=True,
            convert_orientation=True,
            export_global_up_selection="Y",
            export_global_forward_selection="NEGATIVE_Z",
        ),
    )


def write_alembic(frames: Frames, path: Path) -> None:
    """Write the frames; Alembic has y up, and no materials."""
    span = {"start": frames.numbers[0], "end": frames.numbers[-1]}
    _write(
        frames,
        Particles,
        lambda: save(path, bpy.ops.wm.alembic_export, evaluation_mode="RENDER", as_background_job=False, **span),
    )


def _write(frames: Frames, kind: Callable[[Cloud], Points], export: Callable[[], None]) -> None:
    failed: list[Exception] = []
    scene = frames.scene

    def guarded(work: Callable[[int, Any], None]) -> Callable[..., None]:
        def handler(stage: Any, graph: Any = None, *_: Any) -> None:
            if stage.frame_current in frames.numbers and not failed:
                try:
                    work(stage.frame_current, graph)
                except Exception as error:
                    failed.append(error)

        return handler

    def bring(frame: int, _graph: Any) -> None:
        for name, mesh in scene.read_meshes(frame).items():
            moving = scene.moving()[name]
            if mesh is None or len(mesh.triangles) == 0:
                moving.take(_nothing(name, mesh), None)
            else:
                moving.take(moving.build(mesh, name), mesh)
            moving.thing.data.name = name
        for cloud in points:
            cloud.bring(frame)
        frames.done(frame)

    def settle(_frame: int, graph: Any) -> None:
        for cloud in points:
            cloud.settle(graph)

    frames.key()
    frames.shrink_absent_bodies()
    for thing in scene.sampled():
        thing.modifiers.new("sampled", "TRIANGULATE")
    points = [kind(cloud) for cloud in frames.clouds]
    bpy.app.handlers.frame_change_pre.append(guarded(bring))
    bpy.app.handlers.frame_change_post.append(guarded(settle))
    export()
    if failed:
        raise failed[0]


def _nothing(name: str, source: TriangleMesh | None) -> Any:
    """A triangle without area, with the attributes of the mesh that it stands for: exporters go on with the last mesh
    where one is empty."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0.0, 0.0, 0.0)] * 3, [], [(0, 1, 2)])
    if source is not None:
        if source.has("vx", "vy", "vz"):
            mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
        for attribute in attributes_among(source.columns):
            mesh.attributes.new(attribute, "FLOAT", "POINT")
    return mesh
