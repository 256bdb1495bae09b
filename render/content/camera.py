"""Blender's camera from a view."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from mathutils import Matrix

from render.blender.session import bpy
from render.content.axes import Vector, triple, z_up
from render.content.framing import FULL_FRAME, View, rotation_matrix
from render.content.motion import PLACE, blur


def face(thing: Any, position: Vector, toward: Vector) -> None:
    """Place a camera or lamp so that its back points along `toward`."""
    thing.matrix_world = Matrix.Translation(position) @ Matrix(rotation_matrix(toward)).to_4x4()


class Camera:
    """The scene's camera; `view_at` gives its view at a time [s]."""

    def __init__(self, settings: Any, view_at: Callable[[float], View]):
        self._settings = settings
        self._view_at = view_at
        self._lens = bpy.data.cameras.new("camera")
        self._lens.sensor_fit = "AUTO"
        self._lens.sensor_width = 1000 * FULL_FRAME
        self._thing = bpy.data.objects.new("camera", self._lens)
        self._thing.rotation_mode = "QUATERNION"
        bpy.context.scene.collection.objects.link(self._thing)
        bpy.context.scene.camera = self._thing

    def show(self, frame: int, exposure: float, fps: float) -> None:
        """Stand where the settings say, and move on while the shutter is open, `exposure` frames long."""

        def place(offset: float) -> None:
            self._place(self._view_at((frame + offset) / fps))

        moving = exposure if self._settings.keyframes else 0.0
        blur(self._thing, frame, moving, place)
        self._focus(self._view_at(frame / fps))

    def _place(self, view: View) -> None:
        rotation = Matrix(rotation_matrix(_minus(view.position, view.target))).to_quaternion()
        rotation.make_compatible(self._thing.rotation_quaternion)
        self._thing.location, self._thing.rotation_quaternion = view.position, rotation

    def key(self, frame: int, fps: float) -> None:
        """Keep where it is in a frame as keyframes."""
        self._place(self._view_at(frame / fps))
        self._focus(self._view_at(frame / fps))
        for path in PLACE:
            self._thing.keyframe_insert(path, frame=frame)
        for path in ("lens", "clip_start", "clip_end", "dof.focus_distance"):
            self._lens.keyframe_insert(path, frame=frame)

    def _focus(self, view: View) -> None:
        lens, depth = self._lens, self._settings.depth_of_field
        lens.angle = max(view.width_angle, view.height_angle)
        distance = math.dist(view.position, view.target)
        lens.clip_start, lens.clip_end = distance / 1000, distance * 1000
        if depth is not None:
            lens.dof.use_dof = True
            lens.dof.aperture_fstop = depth.f_stop
            lens.dof.focus_distance = view.project(z_up(depth.focus))[2] if depth.focus else distance


def _minus(a: Vector, b: Vector) -> Vector:
    return triple(p - q for p, q in zip(a, b, strict=True))
