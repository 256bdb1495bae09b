"""Glass loses no light: in a world that is white all around, what absorbs nothing cannot be seen.

Light runs along a pane by dozens of total reflections before it leaves, and a path tracer ends long paths.
"""

import pytest

from tests.support.pictures import extent, passes, rest, white_light

LOW, HIGH = (-0.4, 0, -0.3), (0.4, 0.4, 0.3)
CAMERA = {"position": [0.9, 0.7, 1.3], "target": [0, 0.15, 0], "field_of_view": 40}


def cuboid(low, high, without_lid=False):
    """Corners and outward triangles."""
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    if without_lid:
        sides.remove((2, 3, 7, 6))
    return corners, [triangle for a, b, c, d in sides for triangle in ((a, b, c), (a, c, d))]


def tank(simulation, write_mesh):
    write_mesh(simulation / "container_thing.ply", "x y z", *cuboid(LOW, HIGH, without_lid=True))


def block(simulation, write_mesh):
    write_mesh(simulation / "body_thing.ply", "x y z", *cuboid((-0.3, -0.15, -0.2), (0.3, 0.15, 0.2)))
    rest(simulation, thing=(0, 0.15, 0))


@pytest.mark.parametrize("thin", [False, True], ids=["solid", "thin"])
@pytest.mark.parametrize("bounces", [2, 24])
@pytest.mark.parametrize("thing", [tank, block])
def test_white_glass_in_white_light_is_white_to_its_edges(tmp_path, write_mesh, thing, bounces, thin):
    simulation = tmp_path / "simulation"
    extent(simulation, LOW, HIGH)
    thing(simulation, write_mesh)
    look = {"type": "glass", "color": "#ffffff", "thin": thin}
    settings = {"resolution": [48, 27], "bounces": bounces, "camera": CAMERA, "materials": {"thing": look}}
    seen, _ = passes(simulation, tmp_path / "out", **settings, **white_light(tmp_path))
    assert seen.min() == pytest.approx(1, abs=0.01)
    assert seen.max() == pytest.approx(1, abs=0.01)
