"""glTF, as one .glb: what changes its shape is one mesh a frame, of no size in all other frames.

glTF has no meshes whose triangles change. But a node may be scaled by steps, and one of no size need not be drawn
(glTF 2.0, 3.5.2 and 3.11): that shows one mesh after the other in every viewer that plays animations, and the first one
in all others. It has neither area lights nor surroundings, and a camera that cannot zoom.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from common.attributes import attributes_among
from render.blender import versions
from render.blender.session import bpy
from render.content.changing.foam import RADIUS
from render.content.meshes import add_object
from render.export.clouds import NUMBERS
from render.export.frames import Frames, give_size, save
from render.export.glb import add_volumes

THICKNESS = 0.1
"""Of water over the diagonal of the action's box, by which programs refract that trace no rays through it."""


def write_gltf(frames: Frames, path: Path) -> None:
    """Write the frames, the first at 0 s."""
    frames.key()
    scene = frames.scene
    for thing in scene.sampled():
        bpy.data.objects.remove(thing)
    frames.shrink_absent_bodies()
    for frame in frames.numbers:
        for name, mesh in scene.read_meshes(frame).items():
            if mesh is not None and len(mesh.triangles) > 0:
                thing = scene.moving()[name].copy(mesh, f"{name}_{frame:05d}")
                _underscore(thing.data, attributes_among(mesh.columns))
                _show(thing, frame, frames.numbers)
        for cloud in frames.clouds:
            points = cloud.read(frame)
            if points.vertex_count() > 0:
                name = f"{cloud.name}_{frame:05d}"
                _show(add_object(name, _named(cloud.build(name, points)), cloud.material), frame, frames.numbers)
        frames.done(frame)
    _keep_time(frames)
    bpy.context.scene.frame_set(0)
    save(
        path,
        bpy.ops.export_scene.gltf,
        export_format="GLB",
        export_animation_mode="ACTIVE_ACTIONS",
        export_force_sampling=False,
        export_apply=True,
        export_attributes=True,
        export_cameras=True,
        export_lights=True,
        use_mesh_vertices=True,
    )
    add_volumes(path, _volumes(THICKNESS * scene.box.diagonal))


def _volumes(thickness: float) -> dict[str, dict[str, Any]]:
    """What absorbs light, by the names of the materials, as KHR_materials_volume has it."""
    found = {}
    for material in bpy.data.materials:
        for node in material.node_tree.nodes if material.node_tree else ():
            if node.type == "VOLUME_ABSORPTION":
                color, density = (node.inputs[name].default_value for name in ("Color", "Density"))
                tint = {"attenuationColor": list(color[:3]), "attenuationDistance": 1 / density}
                found[material.name] = {"thicknessFactor": thickness, **tint}
    return found


def _named(mesh: Any) -> Any:
    """The mesh of points, with attributes as glTF wants them: names that begin with an underscore, and y up.

    Of velocities each component is one: Blender's importer mixes up numbers and vectors beside each other (4.5).
    """
    flat = array("f", bytes(12 * len(mesh.vertices)))
    mesh.attributes["velocity"].data.foreach_get("vector", flat)
    mesh.attributes.remove(mesh.attributes["velocity"])
    for name, values in (("_vx", flat[0::3]), ("_vy", flat[2::3]), ("_vz", array("f", (-y for y in flat[1::3])))):
        mesh.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", values)
    mesh.attributes[RADIUS].name = "_radius"
    _underscore(mesh, NUMBERS.values())
    return mesh


def _underscore(mesh: Any, names: Iterable[str]) -> None:
    for name in names:
        if name in mesh.attributes:
            mesh.attributes[name].name = f"_{name}"


def _show(thing: Any, frame: int, numbers: range) -> None:
    """Give a thing its size in one frame alone."""
    give_size(thing, {when: when == frame for when in (numbers[0], frame, frame + 1) if when in numbers})


def _keep_time(frames: Frames) -> None:
    """Count frames from 0, and at a whole number of them a second: Blender's exporter takes the divisor of the frame
    rate for a factor."""
    render = bpy.context.scene.render
    render.fps, render.fps_base = max(1, round(frames.fps)), 1.0
    for thing in bpy.data.objects:
        if thing.animation_data is None or thing.animation_data.action is None:
            continue
        for curve in versions.curves(thing):
            for key in curve.keyframe_points:
                key.co.x = (key.co.x - frames.numbers[0]) * render.fps / frames.fps
                key.interpolation = "CONSTANT" if curve.data_path == "scale" else "LINEAR"
