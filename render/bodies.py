"""Rigid bodies: one mesh each, moved from frame to frame."""

from __future__ import annotations

from typing import Any

from mathutils import Quaternion, Vector

from render.blender import bpy
from render.inputs import Pose
from render.meshes import add_object, build_mesh, sharpen
from render.ply import TriangleMesh


class Body:
    """A rigid body in the scene."""

    def __init__(self, name: str, source: TriangleMesh, material: Any):
        mesh = build_mesh(name, source)
        sharpen(mesh)
        self.thing = add_object(name, mesh, material)
        self.thing.rotation_mode = "QUATERNION"

    def show(self, pose: Pose | None, frame: int, exposure: float, fps: float) -> None:
        """Stand where the pose says; it moves on straight and turns evenly while the shutter is open.

        `exposure` is that time in frames, centred on the frame; 0 is without motion blur.
        """
        self.thing.hide_render = pose is None
        self._forget_motion()
        if pose is None:
            return
        moving = exposure > 0 and any((*pose.velocity, *pose.angular_velocity))
        for offset in (-exposure / 2, exposure / 2, 0.0) if moving else (0.0,):
            seconds = offset / fps
            turn = Vector(pose.angular_velocity) * seconds
            self.thing.location = Vector(pose.position) + Vector(pose.velocity) * seconds
            self.thing.rotation_quaternion = Quaternion(turn, turn.length) @ Quaternion(pose.rotation)
            if moving:
                self.thing.keyframe_insert("location", frame=frame + offset)
                self.thing.keyframe_insert("rotation_quaternion", frame=frame + offset)
        if moving:
            for curve in self.thing.animation_data.action.fcurves:
                for key in curve.keyframe_points:
                    key.interpolation = "LINEAR"

    def _forget_motion(self) -> None:
        if self.thing.animation_data is not None:
            action = self.thing.animation_data.action
            self.thing.animation_data_clear()
            bpy.data.actions.remove(action)
