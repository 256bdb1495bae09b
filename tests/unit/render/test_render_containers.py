"""Walls of containers grow outwards, and a little into the water."""

from types import SimpleNamespace

import bpy
import pytest

from render.content.containers import add_container
from render.content.ply import read_mesh


@pytest.mark.parametrize("flipped", [False, True])
def test_a_wall_reaches_from_the_overlap_to_the_thickness(tmp_path, write_mesh, flipped):
    low, high = 0.0, 1.0
    corners = [(x, y, z) for x in (low, high) for y in (low, high) for z in (low, high)]
    sides = [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),
        (0, 4, 5),
        (0, 5, 1),
        (0, 2, 6),
        (0, 6, 4),
        (1, 5, 7),
        (1, 7, 3),
    ]
    if flipped:
        sides = [side[::-1] for side in sides]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    walls = SimpleNamespace(thickness=0.1, overlap=0.02)
    material = bpy.data.materials.new("glass")
    add_container("tank", read_mesh(write_mesh(tmp_path / "tank.ply", "x y z", corners, sides)), walls, material, 1.7)
    evaluated = bpy.data.objects["tank"].evaluated_get(bpy.context.evaluated_depsgraph_get())
    across = sorted({round(vertex.co.x, 4) for vertex in evaluated.data.vertices})
    assert across == pytest.approx([-0.1, 0.02, 0.98, 1.1], abs=1e-3)
