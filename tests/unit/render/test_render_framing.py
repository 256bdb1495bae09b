"""Automatic framing: the box of the action is in the picture, and fills it."""

import math

import pytest

from render.content.axes import z_up
from render.content.framing import direction, frame_box, frame_box_to_scale, view_of
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


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("resolution", [(640, 360), (360, 640), (500, 500)])
@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 0), (24, 17), (-140, 60), (90, -30)])
def test_to_scale_the_box_fills_the_picture_up_to_the_margin(box, resolution, azimuth, elevation):
    margin = 0.1
    view = frame_box_to_scale(box, direction(azimuth, elevation), resolution, margin)
    seen = [view.project(corner) for corner in box.corners()]
    assert all(depth > 0 for _, _, depth in seen)
    assert max(max(abs(across), abs(upward)) for across, upward, _ in seen) == pytest.approx(1 - margin, abs=1e-6)
    for side in (0, 1):
        values = [place[side] for place in seen]
        assert max(values) == pytest.approx(-min(values), abs=1e-6), "in the middle"
    assert view.shown[0] / resolution[0] == pytest.approx(view.shown[1] / resolution[1]), "square pixels"


@pytest.mark.parametrize("elevation", [5, 17, 60])
def test_to_scale_the_lower_edge_begins_above_the_ground(elevation):
    """Rays are parallel: one that began below the ground would see it from beneath."""
    box = BOXES[0]
    view = frame_box_to_scale(box, direction(24, elevation), (640, 360), 0.1)
    edge = view.position[2] - view.shown[1] / 2 * math.cos(math.radians(elevation))
    assert edge > box.low[2]


def test_front_right_and_above_are_where_the_settings_say():
    assert direction(0, 0) == pytest.approx((0, -1, 0))  # +z of the simulation is -y of Blender
    assert direction(90, 0) == pytest.approx((1, 0, 0))
    assert direction(33, 89.999) == pytest.approx((0, 0, 1), abs=1e-4)


@pytest.mark.parametrize("resolution", [(640, 360), (360, 640)])
@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_the_view_agrees_with_blender(projection, resolution):
    import bpy
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    from render.camera_settings import Camera as CameraSettings
    from render.content.camera import Camera

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = resolution
    settings = CameraSettings(projection=projection)
    view = view_of(settings, BOXES[0], resolution)
    Camera(settings, lambda time: view).show(0, 0.5, 24.0)
    bpy.context.view_layer.update()
    for corner in BOXES[0].corners():
        across, upward, depth = view.project(corner)
        found = world_to_camera_view(scene, scene.camera, Vector(corner))
        assert tuple(found) == pytest.approx(((across + 1) / 2, (upward + 1) / 2, depth), abs=1e-4)


def moved(*keyframes, time):
    from render.camera_settings import Camera as CameraSettings

    settings = CameraSettings(keyframes=[{"at": at, "position": p, "target": t} for at, p, t in keyframes])
    return view_of(settings, None, (640, 360), time)


def test_a_camera_that_moves_goes_through_its_keyframes_and_rests_at_both_ends():
    """Closed forms: a Hermite curve goes through its points; between two with slopes 0 it is 3 s^2 - 2 s^3."""
    keys = (0.0, (0, 1, 4), (0, 0, 0)), (2.0, (4, 1, 0), (1, 0, 0)), (3.0, (4, 3, -2), (1, 1, 0))
    for at, position, target in keys:
        view = moved(*keys, time=at)
        assert view.position == pytest.approx(z_up(position)) and view.target == pytest.approx(z_up(target))
    assert moved(*keys, time=-1).position == moved(*keys, time=0).position
    assert moved(*keys, time=9).position == moved(*keys, time=3).position
    for share in (0.25, 0.5, 0.9):
        step = 3 * share**2 - 2 * share**3
        view = moved(*keys[:2], time=2 * share)
        assert view.position == pytest.approx(z_up((4 * step, 1, 4 - 4 * step)))
    h = 1e-4
    before, at, after = (moved(*keys, time=2 + offset).position for offset in (-h, 0, h))
    slopes = [[(b - a) / h for a, b in zip(*pair, strict=True)] for pair in ((before, at), (at, after))]
    assert slopes[0] == pytest.approx(slopes[1], abs=1e-2), "no kink at a keyframe"
    assert slopes[0] == pytest.approx(z_up((4 / 3, 2 / 3, -2)), abs=1e-2), "Catmull and Rom's slope"
