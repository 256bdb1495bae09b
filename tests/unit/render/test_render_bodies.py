"""Rigid bodies stand, move and turn as their poses say."""

import bpy
import pytest
from mathutils import Quaternion, Vector

from render.blender import versions
from render.content.bodies import Body
from render.content.ply import read_mesh
from render.inputs import Pose

FPS = 24.0
POSE = Pose(position=(1, 2, 3), rotation=(1, 0, 0, 0), velocity=(0, 0, -6), angular_velocity=(0, 12, 0))


@pytest.fixture
def body(tmp_path, write_mesh):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    path = write_mesh(tmp_path / "a.ply", "x y z", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    return Body("plate", read_mesh(path), bpy.data.materials.new("plain"))


@pytest.mark.parametrize("offset", [-0.25, -0.125, 0.0, 0.25])
def test_it_moves_and_turns_while_the_shutter_is_open(body, offset):
    body.show(POSE, 7, exposure=0.5, fps=FPS)
    whole = int(7 + offset)
    bpy.context.scene.frame_set(whole, subframe=7 + offset - whole)
    place, turn, _ = body.thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world.decompose()
    assert tuple(place) == pytest.approx((1, 2, 3 - 6 * offset / FPS), abs=1e-5)
    expected = Quaternion(Vector((0, 1, 0)), 12 * offset / FPS)
    assert turn.rotation_difference(expected).angle == pytest.approx(0, abs=1e-3)


def test_it_is_hidden_while_absent_and_leaves_no_motion_behind(body):
    body.show(POSE, 7, exposure=0.5, fps=FPS)
    body.show(None, 8, exposure=0.5, fps=FPS)
    assert body.thing.hide_render
    body.show(POSE, 9, exposure=0.0, fps=FPS)
    assert not body.thing.hide_render
    bpy.context.scene.frame_set(8)
    assert tuple(body.thing.location) == pytest.approx(POSE.position), "it stands, whatever the frame"
    assert len(versions.curves(body.thing)) == 0
    assert len(bpy.data.actions) == 1, "and does not leave one behind in every frame"


def test_what_comes_to_rest_stands_where_it_is_not_where_it_last_moved(body):
    """Blender itself says where, which goes on with curves that it is not told are gone."""
    resting = Pose(position=(5, 6, 7), rotation=(0, 1, 0, 0), velocity=(0, 0, 0), angular_velocity=(0, 0, 0))
    for frame, pose in ((7, POSE), (8, resting)):
        body.show(pose, frame, exposure=0.5, fps=FPS)
        bpy.context.scene.frame_set(frame)
        place, turn, _ = body.thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world.decompose()
        assert tuple(place) == pytest.approx(pose.position, abs=1e-5)
        assert turn.rotation_difference(Quaternion(pose.rotation)).angle == pytest.approx(0, abs=1e-3)
