"""Edges of bodies are rounded where their look says so: as far as it says, and nothing else changes."""

import itertools
import math

import bpy
import pytest
from mathutils import Vector

from render.content.bodies import Body
from render.content.ply import read_mesh

HALF = (0.1, 0.2, 0.3)
CORNERS = [tuple(s * h for s, h in zip(signs, HALF, strict=True)) for signs in itertools.product((-1, 1), repeat=3)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = [triangle for a, b, c, d in SIDES for triangle in ((a, b, c), (a, c, d))]


@pytest.fixture
def box(tmp_path, write_mesh):
    """Makes the mesh of a box, 0.2 x 0.4 x 0.6 m, whose edges have a radius [m]."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    source = read_mesh(write_mesh(tmp_path / "box.ply", "x y z", CORNERS, TRIANGLES))
    return lambda radius, **kinds: (
        Body("box", source, bpy.data.materials.new("plain"), rounding=radius, **kinds).thing.data
    )


def volume(mesh):
    mesh.calc_loop_triangles()
    corners = [[mesh.vertices[vertex].co for vertex in part.vertices] for part in mesh.loop_triangles]
    return sum(a.dot(b.cross(c)) for a, b, c in corners) / 6


def test_edges_are_sharp_unless_told_otherwise(box):
    mesh = box(0.0)
    assert (len(mesh.vertices), len(mesh.polygons)) == (8, 12)


def test_a_rounded_box_is_the_sharp_one_without_its_edges(box):
    """Along an edge, three chords stand for a quarter circle; at a corner, less than a cube of the radius is gone."""
    radius, whole = 0.02, 8 * math.prod(HALF)
    mesh = box(radius)
    for axis, half in zip((0, 2, 1), HALF, strict=True):  # in Blender's axes
        assert max(abs(vertex.co[axis]) for vertex in mesh.vertices) == pytest.approx(half, rel=1e-5)
    cut = radius**2 * (1 - 3 * math.sin(math.pi / 6) / 2)
    along_edges = 8 * sum(HALF) * cut
    assert whole - volume(mesh) == pytest.approx(along_edges, abs=8 * radius**3)
    assert min(abs(abs(v.co[0]) - HALF[0]) + abs(abs(v.co[1]) - HALF[2]) for v in mesh.vertices) > 0.25 * radius


def test_flat_faces_are_shaded_flat_to_where_edges_begin_and_no_crease_shows_there(box):
    mesh = box(0.02)
    shaded = [Vector(corner.vector) for corner in mesh.corner_normals]
    at: dict[int, list[Vector]] = {}
    for corner, loop in enumerate(mesh.loops):
        at.setdefault(loop.vertex_index, []).append(shaded[corner])
    assert max(one.angle(others[0]) for others in at.values() for one in others) < 1e-3
    flat = [face for face in mesh.polygons if face.area > 0.05]
    assert len(flat) == 6 < len(mesh.polygons)
    assert max(shaded[corner].angle(face.normal) for face in flat for corner in face.loop_indices) < 1e-3


def test_a_radius_without_room_rounds_as_much_as_there_is_room_for(box):
    mesh = box(1.0)
    for axis, half in zip((0, 2, 1), HALF, strict=True):
        assert max(abs(vertex.co[axis]) for vertex in mesh.vertices) <= half * (1 + 1e-5)
    assert 0 < volume(mesh) < 8 * math.prod(HALF)


def test_images_stay_where_they_are_on_flat_faces(box):
    """One that lies across x and y of the scene, as metres: so it does when the edges are round."""
    at = [(CORNERS[vertex][0], CORNERS[vertex][1]) for triangle in TRIANGLES for vertex in triangle]
    mesh = box(0.02, uv=[number for place in at for number in place])
    layer = mesh.uv_layers[0]
    front = max(mesh.polygons, key=lambda face: -face.center[1] if face.area > 0.05 else -1)
    for corner in front.loop_indices:
        place, (u, v) = mesh.vertices[mesh.loops[corner].vertex_index].co, layer.uv[corner].vector
        assert (u, v) == pytest.approx((place[0], place[2]), abs=1e-3)
