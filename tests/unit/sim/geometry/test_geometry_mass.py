"""Mass properties against closed forms."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from scene.settings import Refused
from sim.geometry.mass import from_covariance, mass_properties
from sim.geometry.shapes import place
from sim.geometry.spec import Box, Capsule, Cylinder, Placement, Plane, Sphere, Torus
from tests.support.meshes import bow_tie, figure_of_eight

DENSITY = 800.0


def box(a, b, c):
    """I_x = m (b^2 + c^2) / 12"""
    return a * b * c, np.array([b * b + c * c, a * a + c * c, a * a + b * b]) / 12


def sphere(r):
    """I = 2/5 m r^2"""
    return 4 / 3 * np.pi * r**3, np.full(3, 0.4 * r * r)


def cylinder(r, h):
    """I_y = m r^2 / 2, I_x = m (3 r^2 + h^2) / 12"""
    across = (3 * r * r + h * h) / 12
    return np.pi * r * r * h, np.array([across, r * r / 2, across])


def capsule(r, h):
    """Cylinder m_c and two half-spheres m_s together: I_y = m_c r^2/2 + 2/5 m_s r^2,
    I_x = m_c (3 r^2 + h^2)/12 + m_s (2/5 r^2 + h^2/4 + 3/8 h r)"""
    shaft, ends = np.pi * r * r * h, 4 / 3 * np.pi * r**3
    across = shaft * (3 * r * r + h * h) / 12 + ends * (0.4 * r * r + h * h / 4 + 3 / 8 * h * r)
    along = shaft * r * r / 2 + ends * 0.4 * r * r
    return shaft + ends, np.array([across, along, across]) / (shaft + ends)


def torus(r, a):
    """I_y = m (r^2 + 3/4 a^2), I_x = m (4 r^2 + 5 a^2) / 8"""
    across = (4 * r * r + 5 * a * a) / 8
    return 2 * np.pi**2 * r * a * a, np.array([across, r * r + 0.75 * a * a, across])


CASES = [
    (Box(type="box", size=(1, 2, 3)), box(1, 2, 3)),
    (Sphere(type="sphere", radius=0.7), sphere(0.7)),
    (Cylinder(type="cylinder", radius=0.5, height=2), cylinder(0.5, 2)),
    (Capsule(type="capsule", radius=0.5, height=2), capsule(0.5, 2)),
    (Torus(type="torus", radius=1, tube_radius=0.3), torus(1, 0.3)),
]
TURNED = Placement(position=(10, -20, 30), rotation=({"axis": (1, 2, 3), "angle": 40},), scale=1.5)


@pytest.mark.parametrize(("shape", "expected"), CASES)
def test_closed_form(shape, expected):
    volume, per_mass = expected
    found = place(shape, Placement(), Path()).mass_properties(DENSITY)
    assert found.mass == pytest.approx(DENSITY * volume, rel=1e-13)
    np.testing.assert_allclose(found.inertia, found.mass * np.diag(per_mass), rtol=1e-13, atol=1e-12)


@pytest.mark.parametrize(("shape", "expected"), CASES)
def test_mesh_of_a_placed_shape(shape, expected):
    """I = R I_0 R^T with I_0 ~ scale^5; the polyhedron is within 0.4 % of the shape, a box is exact."""
    volume, per_mass = expected
    solid = place(shape, TURNED, Path())
    found = mass_properties(solid.mesh, DENSITY)
    tolerance = 1e-12 if shape.type == "box" else 6e-3
    mass = DENSITY * volume * 1.5**3
    rotation = solid.pose.rotation
    inertia = rotation @ np.diag(mass * 1.5**2 * per_mass) @ rotation.T
    assert found.mass == pytest.approx(mass, rel=tolerance)
    np.testing.assert_allclose(found.centre, [10, -20, 30], atol=1e-12)
    np.testing.assert_allclose(found.inertia, inertia, atol=tolerance * np.abs(inertia).max())
    np.testing.assert_allclose(found.inertia, solid.mass_properties(DENSITY).inertia, atol=tolerance * inertia.max())


def test_principal_axes_diagonalise():
    solid = place(CASES[0][0], TURNED, Path())
    found = solid.mass_properties(DENSITY)
    assert np.linalg.det(found.axes) == pytest.approx(1)
    np.testing.assert_allclose(
        found.axes @ np.diag(found.moments) @ found.axes.T, found.inertia, atol=1e-9 * found.mass
    )
    assert (np.diff(found.moments) >= 0).all()


def test_far_from_the_origin_nothing_cancels():
    mesh = trimesh.creation.box(extents=(1e-2, 2e-2, 3e-2))
    mesh.apply_translation([1000, 2000, 3000])
    found = mass_properties(mesh, 1.0)
    # Vertices at 3000 m carry 5e-13 m of rounding, 5e-11 of the edge.
    np.testing.assert_allclose(np.diag(found.inertia), 6e-6 * box(1e-2, 2e-2, 3e-2)[1], rtol=1e-8)


def test_other_mass():
    found = place(CASES[1][0], Placement(), Path()).mass_properties(DENSITY).scaled_to(2.0)
    np.testing.assert_allclose(found.inertia, 2.0 * 0.4 * 0.7**2 * np.eye(3), rtol=1e-13)


def test_hollow_subtracts(two_cubes):
    """Unit cube less a half-size cube: V = 7/8, I = (1 - 1/32) / 6."""
    found = mass_properties(two_cubes([0, 0, 0], scale=0.5, inverted=True), 1.0)
    assert found.mass == pytest.approx(7 / 8)
    np.testing.assert_allclose(found.inertia, (1 - 1 / 32) / 6 * np.eye(3), atol=1e-14)


def test_pieces_that_touch_or_stand_apart_add(two_cubes):
    for distance in (1.0, 3.0):
        found = mass_properties(two_cubes([distance, 0, 0]), 1.0)
        assert found.mass == pytest.approx(2)
        np.testing.assert_allclose(found.centre, [distance / 2, 0, 0], atol=1e-14)
        assert found.inertia[1, 1] == pytest.approx(2 / 6 + 2 * (distance / 2) ** 2)


def test_open_mesh_is_refused(cube):
    with pytest.raises(Refused, match="open mesh"):
        mass_properties(trimesh.Trimesh(cube.vertices, cube.faces[2:], process=False), 1.0)


def test_inverted_mesh_is_refused(cube):
    with pytest.raises(Refused, match="inside out"):
        mass_properties(trimesh.Trimesh(cube.vertices, cube.faces[:, ::-1], process=False), 1.0)


def test_overlapping_pieces_are_refused(two_cubes):
    """Also a cross of two beams, no vertex of which is inside the other."""
    beam = trimesh.creation.box(extents=(4, 1, 1))
    cross = trimesh.util.concatenate([beam, trimesh.creation.box(extents=(1, 4, 0.9))])
    for mesh in (two_cubes([0.5, 0.4, 0.3]), cross):
        with pytest.raises(Refused, match="overlap") as refused:
            mass_properties(mesh, 1.0)
        assert "union" in refused.value.remedy


@pytest.mark.parametrize("inverted", [False, True])
def test_the_volume_that_counts_wrongly(two_cubes, inverted):
    """Two unit cubes share 0.5 x 0.6 x 0.7; of an inverted one all that lies outside the other is wrong.

    Lines stand (1.5 x 1.4 / 10,000)^(1/2) apart at most, and an edge of the volume is off by half of that.
    """
    from sim.geometry.meshes.overlap import COLUMNS, volume_counted_wrongly

    found = volume_counted_wrongly(two_cubes([0.5, 0.4, 0.3], inverted=inverted))
    spacing = np.sqrt(1.5 * 1.4 / COLUMNS)
    expected, sides = (1 - 0.5 * 0.6 * 0.7, 4 * 1.0) if inverted else (0.5 * 0.6 * 0.7, 2 * 0.5 + 2 * 0.6)
    assert found == pytest.approx(expected, abs=sides * spacing / 2)
    assert volume_counted_wrongly(two_cubes([1.0, 0.4, 0.3])) == 0
    assert volume_counted_wrongly(two_cubes([0, 0, 0], scale=0.5, inverted=True)) == 0


def test_one_piece_that_cuts_through_itself_is_refused():
    for build in (figure_of_eight, lambda: bow_tie((1, 2, 3))):
        with pytest.raises(Refused, match="cuts through itself") as refused:
            mass_properties(trimesh.Trimesh(*build(), process=False), 1.0)
        assert "union" in refused.value.remedy


def test_a_cut_too_small_to_weigh_is_let_pass():
    """The middle of a cube's bottom comes out at the top by 1/2000: the cone of base A leaves V = 1 - A h / 3."""
    mesh = trimesh.creation.box().subdivide().subdivide()
    middle = np.linalg.norm(mesh.vertices - [0, 0, -0.5], axis=1).argmin()
    base = mesh.area_faces[(mesh.faces == middle).any(axis=1)].sum()
    vertices = np.array(mesh.vertices)
    vertices[middle] = [0, 0, 0.5005]
    found = mass_properties(trimesh.Trimesh(vertices, mesh.faces, process=False), 1.0)
    assert found.mass == pytest.approx(1 - base * 1.0005 / 3, rel=1e-12)


def test_moments_of_no_body_are_refused():
    """I = tr(C) 1 - C: a negative second moment along x makes I_x exceed I_y + I_z."""
    with pytest.raises(Refused, match="no body"):
        from_covariance(1.0, 1.0, np.zeros(3), np.diag([-0.1, 1.0, 1.0]))
    with pytest.raises(Refused, match="no finite mass"):
        from_covariance(np.inf, 1.0, np.zeros(3), np.eye(3))


def test_plane_has_no_mass():
    with pytest.raises(Refused, match="no finite mass"):
        place(Plane(type="plane"), Placement(), Path()).mass_properties(1.0)
