"""Where the particles of a layer leave an outlet, and how many they are."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scene.settings import Refused
from sim.fluid.inflow.emitters import find_outlet
from sim.fluid.spec import Emitter, Fluid

D = 0.02
FLUID = Fluid(particle_radius=D / 2)
TURN = [{"axis": [1, 2, -1], "angle": 70}]


def outlet(shape, folder=Path(), **values):
    values = {"speed": 0.5} | values
    return find_outlet("tap", Emitter(shape=shape, **values), FLUID, folder, ("fluid", "emitters", "tap"))


def disc(radius, **values):
    return outlet({"type": "disc", "radius": radius}, **values)


@pytest.mark.parametrize("ratio", np.linspace(0.5, 12, 40))
def test_a_disc_covers_its_area(ratio):
    """|n - pi r^2| <= 2 sqrt(2) pi r for the points of a unit lattice in a circle (Gauss 1834)."""
    found = len(disc(ratio * D).cells)
    assert found > 0
    assert abs(found - math.pi * ratio**2) < 2 * math.sqrt(2) * math.pi * ratio


def test_discs_cover_their_area_on_average():
    """Where the circle cuts the cells is as good as random: the misses of many discs cancel."""
    ratios = np.linspace(3, 12, 40)
    shares = [len(disc(ratio * D).cells) / (math.pi * ratio**2) for ratio in ratios]
    assert np.mean(shares) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("ratio", [3.0, 6.5, 12.0])
def test_a_disc_is_symmetric(ratio):
    across = disc(ratio * D).points[:, [0, 2]] / (D / 2)
    points = {tuple(point) for point in np.round(across).astype(int)}
    assert points == {(-x, z) for x, z in points} == {(z, x) for x, z in points}
    assert np.hypot(*across.T).max() / 2 <= ratio + 1e-9


@pytest.mark.parametrize(
    ("size", "rows"),
    [((0.1, 0.06), (5, 3)), ((0.1 - 1e-9, 0.06 + 1e-9), (5, 3)), ((0.119, 0.079), (5, 3)), ((0.02, 0.2), (1, 10))],
)
def test_a_rectangle_holds_whole_cells(size, rows):
    found = outlet({"type": "rectangle", "size": size})
    assert found.grid == rows and len(found.cells) == rows[0] * rows[1]
    across = found.points[:, [0, 2]]
    np.testing.assert_allclose(across.max(axis=0), (np.array(rows) - 1) / 2 * D, atol=1e-12)
    np.testing.assert_allclose(across.min(axis=0), -across.max(axis=0), atol=1e-12)


def test_it_is_placed_as_a_body_is():
    """The layer's back lies in the outlet, which is turned about its centre and scaled."""
    found = disc(0.03, position=[1, 2, 3], rotation=TURN, scale=2)
    plain = disc(0.06)
    from sim.geometry.pose import rotation_matrix
    from sim.geometry.spec import Rotation

    turn = rotation_matrix(tuple(Rotation(**turn) for turn in TURN))
    np.testing.assert_allclose(found.points, plain.points @ turn.T + [1, 2, 3], atol=1e-12)
    np.testing.assert_allclose(found.velocity, 0.5 * turn @ [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose((found.points - [1, 2, 3]) @ found.direction, D / 2, atol=1e-12)


@pytest.mark.parametrize("shape", [{"type": "disc", "radius": 0.053}, {"type": "rectangle", "size": [0.05, 0.11]}])
def test_a_rate_is_that_of_the_particles(shape):
    """rate = n d^2 v, whatever area the shape itself has."""
    found = outlet(shape, speed=None, rate=2e-3)
    assert found.rate == pytest.approx(2e-3, rel=1e-12)
    assert len(found.cells) * D**2 * found.speed == pytest.approx(2e-3, rel=1e-12)
    assert found.particle_rate * D**3 == pytest.approx(2e-3, rel=1e-12)


@pytest.fixture
def prism(tmp_path):
    """A prism over an L of three squares of 0.1 m, standing on z = 0; the file's up is z."""
    corners = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]) / 10
    triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]])
    top, bottom = np.column_stack((corners, np.full(6, 0.3))), np.column_stack((corners, np.zeros(6)))
    sides = [face for k in range(6) for face in ([k, (k + 1) % 6, k + 6], [(k + 1) % 6, (k + 1) % 6 + 6, k + 6])]
    mesh = trimesh.Trimesh(
        np.concatenate((bottom, top)), [*triangles[:, ::-1], *sides, *(triangles + 6)], process=False
    )
    assert mesh.is_watertight and mesh.volume == pytest.approx(0.009)
    mesh.export(tmp_path / "prism.ply")
    return tmp_path


@pytest.mark.parametrize("face", [16, 17, 18, 19])
def test_a_face_of_a_mesh_with_all_in_its_plane(prism, face):
    """An L of 0.03 m^2, whose edges lie between the lattice's points: 75 particles, outward is up."""
    found = outlet({"type": "mesh", "file": "prism.ply", "up": "z", "face": face}, prism, position=[0, 1, 0])
    np.testing.assert_allclose(found.direction, [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(found.points[:, 1], 1.3 + D / 2)
    x, y = found.points[:, 0], -found.points[:, 2]
    inside = (x > 0) & (y > 0) & (np.maximum(x, y) < 0.2) & (np.minimum(x, y) < 0.1)
    assert inside.all()
    assert len(found.cells) == 75


def test_a_face_at_the_side_points_sideways(prism):
    found = outlet({"type": "mesh", "file": "prism.ply", "up": "z", "face": 4}, prism)
    np.testing.assert_allclose(found.direction, [0, 0, 1], atol=1e-12)
    assert len(found.cells) == 10 * 15


REFUSED = {
    "small disc": ({"type": "disc", "radius": 0.009}, "smaller than one particle", ("shape",)),
    "narrow rectangle": ({"type": "rectangle", "size": [0.5, 0.019]}, "smaller than one particle", ("shape",)),
    "immense disc": ({"type": "disc", "radius": 1e6}, "max_particles", ("shape",)),
    "face": ({"type": "mesh", "file": "prism.ply", "face": 20}, "the mesh has 20 triangles", ("shape", "face")),
    "no file": ({"type": "mesh", "file": "prisma.ply", "face": 0}, "does not exist", ("shape", "file")),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_outlet_is_refused(prism, case):
    shape, message, field = REFUSED[case]
    with pytest.raises(Refused, match=message) as refused:
        outlet(shape, prism)
    assert refused.value.location == ("fluid", "emitters", "tap", *field)


def test_it_lets_nothing_out_before_start_or_after_stop():
    found = disc(0.03, start=1, stop=3)
    assert found.distance(0, 1) == found.distance(3, 4) == 0
    assert found.distance(0.5, 1.5) == found.distance(2.5, 3.5) == pytest.approx(0.25)
    assert found.distance(0, 4) == pytest.approx(1.0)
