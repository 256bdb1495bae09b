"""Automatic framing: the box of the action is in the picture, and fills it."""

import pytest

from render.framing import direction, frame_box
from render.inputs import Box

BOXES = [
    Box((-1, -1, 0), (1, 1, 2)),
    Box((0, 0, 0), (20, 0.5, 0.1)),
    Box((100, -3, 5), (100.1, -2, 30)),
]


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("resolution", [(640, 360), (360, 640), (500, 500)])
@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 0), (24, 17), (-140, 60), (90, -30)])
def test_all_corners_are_within_the_margin_and_one_touches_it(box, resolution, azimuth, elevation):
    margin = 0.1
    view = frame_box(box, direction(azimuth, elevation), resolution, 32.0, margin)
    seen = [view.project(corner) for corner in box.corners()]
    assert all(depth > 0 for _, _, depth in seen)
    furthest = max(max(abs(across), abs(upward)) for across, upward, _ in seen)
    assert furthest == pytest.approx(1 - margin, abs=1e-6)


def test_front_right_and_above_are_where_the_settings_say():
    assert direction(0, 0) == pytest.approx((0, -1, 0))  # +z of the simulation is -y of Blender
    assert direction(90, 0) == pytest.approx((1, 0, 0))
    assert direction(33, 89.999) == pytest.approx((0, 0, 1), abs=1e-4)


def test_the_view_agrees_with_blender():
    import bpy
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    from render.camera import add_camera
    from render.spec import Camera

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 640, 360
    view = frame_box(BOXES[0], direction(24, 17), (640, 360), 32.0, 0.1)
    add_camera(Camera(), view)
    bpy.context.view_layer.update()
    for corner in BOXES[0].corners():
        across, upward, depth = view.project(corner)
        found = world_to_camera_view(scene, scene.camera, Vector(corner))
        assert tuple(found) == pytest.approx(((across + 1) / 2, (upward + 1) / 2, depth), abs=1e-4)
