"""Shapes: closed forms of volume and distance, triangles, placement, mesh files."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from scene.settings import Refused
from sim.geometry.shapes import load_mesh, place
from sim.geometry.spec import Box, Capsule, Cylinder, MeshFile, Placement, Plane, Sheet, Sphere, Torus
from sim.geometry.tessellation import tessellate
from sim.geometry.triangles import vertex_colors

PI = np.pi
BOX = Box(type="box", size=(1, 2, 3))
SPHERE = Sphere(type="sphere", radius=0.7)
CYLINDER = Cylinder(type="cylinder", radius=0.5, height=2)
CAPSULE = Capsule(type="capsule", radius=0.5, height=2)
TORUS = Torus(type="torus", radius=1, tube_radius=0.3)
# V of each: a b c; 4/3 pi r^3; pi r^2 h; pi r^2 (h + 4/3 r); 2 pi^2 R r^2
VOLUMES = [
    (BOX, 6.0),
    (SPHERE, 4 / 3 * PI * 0.7**3),
    (CYLINDER, PI * 0.25 * 2),
    (CAPSULE, PI * 0.25 * (2 + 4 / 3 * 0.5)),
    (TORUS, 2 * PI**2 * 0.09),
]
SHAPES = [shape for shape, _ in VOLUMES]
TURNED = Placement(position=(1, -2, 3), rotation=({"axis": (1, 2, 3), "angle": 40},), scale=1.5)


def names(shape):
    return shape.type


@pytest.mark.parametrize(("shape", "volume"), VOLUMES)
def test_volume(shape, volume):
    assert place(shape, Placement(), Path()).volume == pytest.approx(volume, rel=1e-14)
    assert place(shape, TURNED, Path()).volume == pytest.approx(1.5**3 * volume, rel=1e-14)


@pytest.mark.parametrize(("shape", "volume"), VOLUMES)
def test_triangles_are_closed_outward_and_on_the_surface(shape, volume):
    """An inscribed polyhedron with chord error e lacks a share of the volume of order e."""
    solid = place(shape, TURNED, Path())
    assert solid.mesh.is_watertight
    assert solid.mesh.is_winding_consistent
    assert solid.mesh.euler_number == (0 if shape.type == "torus" else 2)
    assert solid.mesh.volume == pytest.approx(solid.volume, rel=4e-3)
    assert np.abs(solid.signed_distance(solid.mesh.vertices)).max() < 1e-13
    np.testing.assert_allclose(solid.mesh.bounds, solid.bounds, atol=3e-3)


@pytest.mark.parametrize("shape", [SPHERE, CYLINDER, CAPSULE, TORUS], ids=names)
def test_tessellation_converges(shape):
    """Volume error of order of the chord error: 16 times finer leaves less than 1/8."""
    volume = place(shape, Placement(), Path()).volume
    coarse, fine = (abs(tessellate(shape, chord_error=error).mesh().volume - volume) for error in (1.6e-2, 1e-3))
    assert fine < coarse / 8


def test_sheet_is_an_open_rectangle_facing_up():
    mesh = tessellate(Sheet(type="sheet", size=(2, 3))).mesh()
    assert mesh.area == pytest.approx(6)
    np.testing.assert_allclose(mesh.face_normals, [[0, 1, 0], [0, 1, 0]])
    np.testing.assert_allclose(mesh.extents, [2, 0, 3])


@pytest.mark.parametrize(
    ("shape", "point", "distance"),
    [
        (BOX, (0, 0, 0), -0.5),
        (BOX, (0.4, 0, 0), -0.1),
        (BOX, (3.5, 5, 1.5), 5.0),  # sqrt(3^2 + 4^2) from the edge
        (SPHERE, (0, 0.2, 0), -0.5),
        (SPHERE, (3, 4, 0), 4.3),
        (CYLINDER, (0.1, 0.9, 0), -0.1),
        (CYLINDER, (0.4, 0, 0), -0.1),
        (CYLINDER, (3.5, 5, 0), 5.0),
        (CAPSULE, (0, 1.25, 0), -0.25),
        (CAPSULE, (3, 5, 0), 4.5),
        (TORUS, (1, 0, 0), -0.3),
        (TORUS, (0, 0, 0), 0.7),
        (TORUS, (0, 4, 4), 4.7),
        (Plane(type="plane"), (7, -2, 9), -2.0),
        (Plane(type="plane", normal=(3, 4, 0)), (3, 4, 0), 5.0),
        (Sheet(type="sheet", size=(2, 2)), (4, 4, 0), 5.0),
    ],
)
def test_signed_distance(shape, point, distance):
    assert place(shape, Placement(), Path()).signed_distance(np.array([point])) == pytest.approx([distance], abs=1e-14)


@pytest.mark.parametrize("shape", SHAPES, ids=names)
def test_signed_distance_of_a_placed_shape_is_that_to_its_mesh(shape, random):
    """Against the nearest of many surface points, whose own spacing s makes it high by s^2 / 2d at most."""
    solid = place(shape, TURNED, Path())
    points = random.uniform(solid.bounds[0] - 0.5, solid.bounds[1] + 0.5, (2000, 3))
    surface, _ = trimesh.sample.sample_surface(solid.mesh, 200_000, seed=1)
    reference, _ = cKDTree(surface).query(points)
    np.testing.assert_allclose(np.abs(solid.signed_distance(points)), reference, atol=0.03)
    fraction = solid.contains(random.uniform(*solid.bounds, (200_000, 3))).mean()
    # Monte Carlo: standard error 1/(2 sqrt(n)) at most, four of them.
    assert fraction == pytest.approx(solid.volume / np.prod(np.diff(solid.bounds, axis=0)), abs=4 / (2 * np.sqrt(2e5)))


def test_turns_apply_in_the_order_given():
    """x -> (90 about z) y -> (90 about x) z; the other order would leave x at y."""
    turns = ({"axis": (0, 0, 1), "angle": 90}, {"axis": (1, 0, 0), "angle": 90})
    solid = place(Box(type="box", size=(4, 1, 2)), Placement(rotation=turns, position=(0, 0, 10), scale=2), Path())
    np.testing.assert_array_equal(solid.bounds, [[-1, -2, 6], [1, 2, 14]])
    np.testing.assert_allclose(solid.pose.rotation @ [1, 0, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(solid.pose.to_world(np.array([[1.0, 0, 0]])), [[0, 0, 12]], atol=1e-15)


def test_plane_moves_with_its_placement():
    solid = place(Plane(type="plane"), Placement(position=(0, 2, 0)), Path())
    assert solid.mesh is None
    assert solid.bounds[1, 1] == 2
    assert solid.contains(np.array([[5, 1.9, 5], [5, 2.1, 5]])).tolist() == [True, False]


# Mesh files


def write_ramp(path):
    """A wedge 3 x 2 x 1 whose corner is the origin, so that all three axes differ."""
    hull = trimesh.convex.convex_hull([[0, 0, 0], [3, 0, 0], [0, 2, 0], [3, 2, 0], [0, 0, 1], [0, 2, 1]])
    hull.export(path)
    return hull.volume


@pytest.mark.parametrize(("up", "point_in_file"), [("x", (1, 0, 0)), ("y", (0, 1, 0)), ("z", (0, 0, 1))])
def test_up_axis_becomes_y_without_mirroring(tmp_path, up, point_in_file):
    path = tmp_path / "ramp.ply"
    volume = write_ramp(path)
    file = trimesh.load_mesh(path, process=False)
    mesh, _ = load_mesh(MeshFile(type="mesh", file="ramp.ply", up=up), path)
    assert mesh.volume == pytest.approx(volume)
    assert np.ptp(mesh.vertices[:, 1]) == pytest.approx(np.ptp(file.vertices @ point_in_file))
    # A mirrored copy would keep the distances but not the handedness of the corners.
    corner = [np.array(corner, dtype=float) for corner in ((0, 0, 0), (3, 0, 0), (0, 2, 0), (0, 0, 1))]
    turn = {"x": lambda p: [-p[1], p[0], p[2]], "y": lambda p: list(p), "z": lambda p: [p[0], p[2], -p[1]]}[up]
    turned = np.array([turn(p) for p in corner])
    assert cKDTree(mesh.vertices).query(turned)[0].max() < 1e-6
    assert np.linalg.det(turned[1:] - turned[0]) > 0


def test_size_and_anchor(tmp_path):
    path = tmp_path / "ramp.ply"
    write_ramp(path)
    origin, _ = load_mesh(MeshFile(type="mesh", file="ramp.ply", size=6), path)
    np.testing.assert_allclose(origin.bounds, [[0, 0, 0], [6, 4, 2]], atol=1e-6)
    center, _ = load_mesh(MeshFile(type="mesh", file="ramp.ply", size=6, anchor="center"), path)
    np.testing.assert_allclose(center.bounds, [[-3, -2, -1], [3, 2, 1]], atol=1e-6)
    base, _ = load_mesh(MeshFile(type="mesh", file="ramp.ply", size=6, anchor="base"), path)
    np.testing.assert_allclose(base.bounds, [[-3, 0, -1], [3, 4, 1]], atol=1e-6)


def test_bunny_stands_on_its_base():
    """The file is z up: extents 50.0 x 38.7 x 49.4, so y must be the third and z the second."""
    shape = MeshFile(type="mesh", file="pymeshfix:examples/StanfordBunny.ply", up="z", size=0.5, anchor="base")
    solid = place(shape, Placement(position=(0, 1, 0)), Path())
    extents = np.diff(solid.bounds, axis=0)[0]
    np.testing.assert_allclose(extents, 0.5 * np.array([49.955, 49.386, 38.699]) / 49.955, rtol=1e-4)
    assert solid.bounds[0, 1] == pytest.approx(1)
    assert solid.volume == pytest.approx(24_956 * (0.5 / 49.955) ** 3, rel=1e-3)
    assert solid.report.holes == 5


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.ply", b"", "cannot be read"),
        ("a.obj", b"nothing here", "(cannot be read|no faces)"),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
            b"property float z\nend_header\n0 0 0\n",
            "(cannot be read|no faces)",
        ),
        ("a.xyzzy", b"1 2 3", "in no format that is read"),
        ("a.stl", b"solid x\nendsolid x\n", "(cannot be read|no faces)"),
    ],
)
def test_unreadable_file_is_refused_at_its_field(tmp_path, name, content, says):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(Refused, match=says) as refused:
        place(MeshFile(type="mesh", file=name), Placement(), tmp_path)
    assert refused.value.location == ("shape", "file")
    assert refused.value.remedy


def test_missing_file_is_refused_at_its_field(tmp_path):
    with pytest.raises(Refused, match="does not exist") as refused:
        place(MeshFile(type="mesh", file="none.ply"), Placement(), tmp_path)
    assert refused.value.location == ("shape", "file")


# Inside test and distance of meshes


@pytest.fixture
def placed_file(tmp_path):
    def build(mesh, placement=None):
        mesh.export(tmp_path / "mesh.ply")
        return place(MeshFile(type="mesh", file="mesh.ply"), placement or Placement(), tmp_path)

    return build


def test_mesh_agrees_with_the_closed_form(placed_file, random):
    """A cube as a mesh, float32 in the file: exact but for points within rounding of the surface."""
    solid = placed_file(trimesh.creation.box(extents=(1, 2, 3)), TURNED)
    exact = place(BOX, TURNED, Path())
    points = random.uniform(solid.bounds[0] - 0.3, solid.bounds[1] + 0.3, (20_000, 3))
    np.testing.assert_allclose(solid.signed_distance(points), exact.signed_distance(points), atol=1e-3)
    near = np.abs(exact.signed_distance(points)) < 0.05
    np.testing.assert_allclose(solid.signed_distance(points[near]), exact.signed_distance(points[near]), atol=1e-12)


def test_lattice_through_vertices_and_edges_is_decided_consistently(placed_file):
    """Columns that pass exactly through vertices, edges and faces seen edge-on."""
    solid = placed_file(trimesh.creation.box(extents=(2, 2, 2)))
    axis = np.arange(-1.5, 1.75, 0.25)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    distance = np.abs(points).max(axis=1) - 1
    inside = solid.contains(points)
    assert inside[distance < 0].all()
    assert not inside[distance > 0].any()
    # Half-open: each face owns its points or not, so the count is that of a whole number of layers.
    assert inside.sum() == 8**3
    lattice = solid.contains_lattice(np.full(3, -1.5), 0.25, (13, 13, 13))
    np.testing.assert_array_equal(lattice.ravel(), inside)


def test_overlapping_pieces_unite(two_cubes, placed_file):
    """Parity would call the overlap outside."""
    solid = placed_file(two_cubes([0.5, 0, 0]))
    assert solid.contains(np.array([[0.25, 0.1, 0.2], [0.9, 0, 0.1], [1.1, 0, 0]])).tolist() == [True, True, False]


def test_hollow_is_outside(two_cubes, placed_file):
    solid = placed_file(two_cubes([0, 0, 0], scale=0.5, inverted=True))
    assert solid.contains(np.array([[0, 0, 0], [0.4, 0.1, 0.2]])).tolist() == [False, True]


def test_bunny_answers_like_trimesh(random):
    shape = MeshFile(type="mesh", file="pymeshfix:examples/StanfordBunny.ply", up="z", size=1)
    solid = place(shape, Placement(), Path())
    points = random.uniform(*solid.bounds, (400_000, 3))
    inside = solid.contains(points)
    share = solid.volume / np.prod(np.diff(solid.bounds, axis=0))
    assert inside.mean() == pytest.approx(share, abs=4 * np.sqrt(share * (1 - share) / len(points)))
    few = points[:100]
    reference = -trimesh.proximity.signed_distance(solid.mesh, few)
    np.testing.assert_allclose(solid.signed_distance(few), reference, rtol=5e-3)
    near = np.abs(reference) < 0.03
    assert near.any()
    np.testing.assert_allclose(solid.signed_distance(few[near]), reference[near], atol=1e-6)


@pytest.mark.parametrize("repair", [True, False])
def test_colours_of_a_mesh_file_stay_at_their_places(tmp_path, cube, repair):
    cube.visual.vertex_colors = np.rint(255 * (cube.vertices + 0.5)).astype(np.uint8)
    cube.export(tmp_path / "cube.ply")
    shape = MeshFile(type="mesh", file="cube.ply", up="z", size=2, anchor="base", repair=repair)
    solid = place(shape, Placement(), tmp_path)
    x, y, z = solid.mesh.vertices.T
    expected = 255 * np.column_stack([(x + 1) / 2, (1 - z) / 2, y / 2])
    np.testing.assert_allclose(vertex_colors(solid.mesh)[:, :3], expected)


def test_a_mesh_file_without_colours_has_none(tmp_path, cube):
    cube.export(tmp_path / "cube.stl")
    solid = place(MeshFile(type="mesh", file="cube.stl"), Placement(), tmp_path)
    assert vertex_colors(solid.mesh) is None
