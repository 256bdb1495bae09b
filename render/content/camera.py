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
    """The scene's camera; `view_at` gives its view at a time [s].

    With `stand` one that moves stands still in every frame, and what it sees moves past it: the pass of motion takes
    an orthographic camera that moves for a perspective one (Blender 4.5).
    """

    def __init__(self, settings: Any, view_at: Callable[[float], View], stand: bool = False):
        self._settings = settings
        self._seen: Any = None
        if stand and settings.keyframes:
            self._seen = bpy.data.objects.new("seen", None)
            self._seen.rotation_mode = "QUATERNION"
            bpy.context.scene.collection.objects.link(self._seen)
        self._view_at = view_at
        self._lens = bpy.data.cameras.new("camera")
        self._lens.sensor_fit = "AUTO"
        self._lens.sensor_width = 1000 * FULL_FRAME
        self._lens.type = "ORTHO" if settings.projection == "orthographic" else "PERSP"
        self._thing = bpy.data.objects.new("camera", self._lens)
        self._thing.rotation_mode = "QUATERNION"
        bpy.context.scene.collection.objects.link(self._thing)
        bpy.context.scene.camera = self._thing

    def take_along(self) -> None:
        """Have all that is in the scene by now move past a camera that stands."""
        for thing in bpy.data.objects if self._seen is not None else ():
            if thing.type == "MESH" and thing.parent is None:
                thing.parent = self._seen

    def show(self, frame: int, exposure: float, fps: float) -> None:
        """Stand where the settings say, and move on while the shutter is open, `exposure` frames long."""
        now = self._view_at(frame / fps)

        def place(offset: float) -> None:
            self._place(self._view_at((frame + offset) / fps))

        def pass_by(offset: float) -> None:
            moved = _pose(now) @ _pose(self._view_at((frame + offset) / fps)).inverted()
            self._seen.location, self._seen.rotation_quaternion, _ = moved.decompose()

        if self._seen is None:
            blur(self._thing, frame, exposure if self._settings.keyframes else 0.0, place)
        else:
            self._place(now)
            blur(self._seen, frame, exposure, pass_by)
        self._focus(now)

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
        for path in ("lens", "ortho_scale", "clip_start", "clip_end", "dof.focus_distance"):
            self._lens.keyframe_insert(path, frame=frame)

    def _focus(self, view: View) -> None:
        lens, depth = self._lens, self._settings.depth_of_field
        if view.shown is None:
            lens.angle = max(view.width_angle, view.height_angle)
        else:
            lens.ortho_scale = max(view.shown)
        distance = math.dist(view.position, view.target)
        lens.clip_start, lens.clip_end = distance / 1000, distance * 1000
        if depth is not None:
            lens.dof.use_dof = True
            lens.dof.aperture_fstop = depth.f_stop
            lens.dof.focus_distance = view.project(z_up(depth.focus))[2] if depth.focus else distance


def _pose(view: View) -> Matrix:
    """From the camera's axes to the world's."""
    turn = Matrix(rotation_matrix(_minus(view.position, view.target))).to_4x4()
    return Matrix.Translation(view.position) @ turn


def _minus(a: Vector, b: Vector) -> Vector:
    return triple(p - q for p, q in zip(a, b, strict=True))
