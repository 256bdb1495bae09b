"""Rigid bodies: one mesh each, moved from frame to frame."""

from __future__ import annotations

from typing import Any

from mathutils import Quaternion, Vector

from render.content.meshes import add_object, build_mesh, divide, lay, sharpen
from render.content.motion import PLACE, blur, forget, show_only
from render.content.ply import TriangleMesh
from render.content.rounding import round_edges
from render.inputs import Pose


class Body:
    """A rigid body in the scene; `uv` says where images lie on it, flat [6 m], `rounding` is the radius of its
    edges [m]."""

    def __init__(self, name: str, source: TriangleMesh, *materials: Any, uv: Any = None, rounding: float = 0.0):
        mesh = build_mesh(name, source)
        sharpen(mesh)
        lay(mesh, uv)
        if source.material is not None and len(materials) > 1:
            divide(mesh, source.material, len(materials))
        if rounding > 0:
            round_edges(mesh, rounding)
        self.thing = add_object(name, mesh, *materials)
        self.thing.rotation_mode = "QUATERNION"

    def key(self, pose: Pose | None, frame: int) -> None:
        """Keep where it is in a frame as keyframes; out of sight without a pose."""
        show_only(self.thing, pose is not None, frame)
        if pose is not None:
            rotation = Quaternion(pose.rotation)
            rotation.make_compatible(self.thing.rotation_quaternion)
            self.thing.location, self.thing.rotation_quaternion = pose.position, rotation
            for path in PLACE:
                self.thing.keyframe_insert(path, frame=frame)

    def show(self, pose: Pose | None, frame: int, exposure: float, fps: float) -> None:
        """Stand where the pose says; it moves on straight and turns evenly while the shutter is open.

        `exposure` is that time in frames, centred on the frame; 0 is without motion blur.
        """
        self.thing.hide_render = pose is None
        if pose is None:
            forget(self.thing)
            return

        def place(offset: float) -> None:
            seconds = offset / fps
            turn = Vector(pose.angular_velocity) * seconds
            self.thing.location = Vector(pose.position) + Vector(pose.velocity) * seconds
            self.thing.rotation_quaternion = Quaternion(turn, turn.length) @ Quaternion(pose.rotation)

        moving = any((*pose.velocity, *pose.angular_velocity))
        blur(self.thing, frame, exposure if moving else 0.0, place)
