"""Blender's camera from a view."""

from __future__ import annotations

import math
from typing import Any

from mathutils import Matrix

from render.axes import Vector, z_up
from render.blender import bpy
from render.framing import FULL_FRAME, View, rotation_matrix


def face(thing: Any, position: Vector, toward: Vector) -> None:
    """Place a camera or lamp so that its back points along `toward`."""
    thing.matrix_world = Matrix.Translation(position) @ Matrix(rotation_matrix(toward)).to_4x4()


def add_camera(settings: Any, view: View) -> None:
    """Add the scene's camera."""
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit = "AUTO"
    lens.sensor_width = 1000 * FULL_FRAME
    lens.angle = max(view.width_angle, view.height_angle)
    distance = math.dist(view.position, view.target)
    lens.clip_start, lens.clip_end = distance / 1000, distance * 1000
    if settings.depth_of_field is not None:
        focus = settings.depth_of_field.focus
        lens.dof.use_dof = True
        lens.dof.aperture_fstop = settings.depth_of_field.f_stop
        lens.dof.focus_distance = view.project(z_up(focus))[2] if focus else distance
    camera = bpy.data.objects.new("camera", lens)
    face(camera, view.position, tuple(p - q for p, q in zip(view.position, view.target, strict=True)))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
