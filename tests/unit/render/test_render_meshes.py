"""From PLY files to Blender meshes."""

import math

import pytest

from render.content import ply
from render.content.axes import z_up, z_up_quaternion
from render.content.meshes import build_mesh
from render.content.nodes import TINT
from render.content.ply import read_mesh
from render.errors import Unusable

NAMES = "x y z nx ny nz vx vy vz"
TRIANGLE = [(1, 2, 3, 0, 1, 0, 4, 5, 6), (2, 2, 3, 0, 1, 0, 4, 5, 6), (1, 2, 5, 0, 1, 0, 7, 8, 9)]


@pytest.fixture(params=["numpy", "struct"])
def reader(request, monkeypatch):
    if request.param == "struct":
        monkeypatch.setattr(ply, "np", None)


def test_positions_and_velocities_turn_from_y_up_to_z_up(reader, tmp_path, write_mesh):
    mesh = build_mesh("triangle", read_mesh(write_mesh(tmp_path / "a.ply", NAMES, TRIANGLE, [(0, 1, 2)])))
    assert tuple(mesh.vertices[0].co) == (1.0, -3.0, 2.0)
    assert tuple(mesh.vertices[2].co) == (1.0, -5.0, 2.0)
    velocity = mesh.attributes["velocity"]
    assert (velocity.data_type, velocity.domain) == ("FLOAT_VECTOR", "POINT")
    assert tuple(velocity.data[2].vector) == (7.0, -9.0, 8.0)
    assert [tuple(face.vertices) for face in mesh.polygons] == [(0, 1, 2)]
    assert mesh.polygons[0].use_smooth


def test_fluid_has_an_edge_where_it_ends_at_a_wall(tmp_path, write_mesh):
    """Water to the right of the wall x = 0, level at y = 1: on the level, smooth shading knows nothing of the wall."""
    at_wall, level = (-1, 0, 0), (0, 1, 0)
    places = [((0, 1, 0), at_wall), ((0, 1, 1), at_wall), ((0, 0, 0), at_wall), ((1, 1, 0), level), ((1, 1, 1), level)]
    vertices = [(*place, *normal, 0, 0, 0) for place, normal in places]
    faces = [(0, 2, 1), (0, 1, 3), (1, 4, 3), (0, 0, 1)]
    mesh = build_mesh("water", read_mesh(write_mesh(tmp_path / "a.ply", NAMES, vertices, faces)))
    assert len(mesh.polygons) == 3
    for face in mesh.polygons:
        assert face.use_smooth
        for corner in face.vertices:
            assert tuple(mesh.vertices[corner].normal) == pytest.approx(tuple(face.normal))
    assert {tuple(face.normal) for face in mesh.polygons} == {(-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)}
    assert len(mesh.attributes["velocity"].data) == len(mesh.vertices)


def test_colours_become_light(reader, tmp_path, write_mesh):
    names = "x y z red green blue"
    corners = [(0, 0, 0, 255, 0, 0), (1, 0, 0, 0, 255, 0), (0, 1, 0, 0, 0, 188)]
    mesh = build_mesh("triangle", read_mesh(write_mesh(tmp_path / "a.ply", names, corners, [(0, 1, 2)])))
    tint = mesh.attributes[TINT]
    assert (tint.data_type, tint.domain) == ("FLOAT_COLOR", "POINT")
    assert tuple(tint.data[0].color) == (1, 0, 0, 1)
    assert tuple(tint.data[2].color) == pytest.approx((0, 0, 0.503, 1), abs=1e-3)


def test_an_empty_surface_is_an_empty_mesh(reader, tmp_path, write_mesh):
    mesh = build_mesh("nothing", read_mesh(write_mesh(tmp_path / "a.ply", NAMES, [], [])))
    assert len(mesh.vertices) == len(mesh.polygons) == 0


def test_a_file_cut_short_is_refused(reader, tmp_path, write_mesh):
    path = write_mesh(tmp_path / "a.ply", NAMES, TRIANGLE, [(0, 1, 2)])
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(Unusable, match=r"a\.ply is not a whole binary triangle mesh"):
        read_mesh(path)


def test_numbers_that_are_not_finite_are_refused(reader, tmp_path, write_mesh):
    vertices = [TRIANGLE[0], TRIANGLE[1], (1, math.nan, *TRIANGLE[2][2:])]
    with pytest.raises(Unusable, match="y of a vertex is not finite"):
        read_mesh(write_mesh(tmp_path / "a.ply", NAMES, vertices, [(0, 1, 2)]))


def test_an_index_beyond_the_vertices_is_refused(reader, tmp_path, write_mesh):
    with pytest.raises(Unusable, match="beyond the 3"):
        read_mesh(write_mesh(tmp_path / "a.ply", NAMES, TRIANGLE, [(0, 1, 3)]))


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(Unusable, match="No such file"):
        read_mesh(tmp_path / "gone.ply")


def test_turning_then_mapping_is_mapping_then_turning():
    # M R(q) v = R(M q) M v
    turn, vector = (0.5, 0.1, -0.7, 0.5), (0.3, -0.2, 0.9)
    first = z_up(_rotate(turn, vector))
    assert first == pytest.approx(_rotate(z_up_quaternion(turn), z_up(vector)))


def _rotate(quaternion, vector):
    w, *axis = quaternion
    norm = math.sqrt(sum(part * part for part in quaternion))
    w, axis = w / norm, [part / norm for part in axis]
    twice = [2 * part for part in _cross(axis, vector)]
    return tuple(v + w * t + c for v, t, c in zip(vector, twice, _cross(axis, twice), strict=True))


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
