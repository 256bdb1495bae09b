"""Repair: closed, outward meshes from broken ones, an honest report, and refusals."""

import numpy as np
import pytest
import trimesh

from scene.settings import Refused
from sim.geometry.meshes.repair import repair
from sim.geometry.meshes.topology import cleaned
from sim.geometry.shapes import load_mesh
from sim.geometry.spec import MeshFile
from tests.support.meshes import with_a_seam


def closed_by_trimesh(mesh):
    return mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0


def test_bunny_scan_becomes_one_closed_surface(bunny_file):
    mesh, report = load_mesh(MeshFile(type="mesh", file="bunny"), bunny_file)
    assert closed_by_trimesh(mesh)
    assert mesh.euler_number == 2
    assert mesh.volume == pytest.approx(24_956, rel=1e-3)
    assert report.holes == 5
    assert report.non_manifold_edges == 132
    assert report.components_after == 1
    text = "; ".join(report.lines())
    assert "closed 5 holes" in text
    assert "removed 132 non-manifold edges" in text
    assert "dropped 66 of 67 separate pieces" in text
    assert report.faces_dropped == 66


def test_sound_mesh_is_left_alone(cube):
    mesh, report = repair(cube, name="cube")
    assert not report.changed
    assert report.lines() == []
    assert mesh.volume == pytest.approx(1)
    assert len(mesh.faces) == 12


def test_missing_face_is_closed(cube):
    mesh, report = repair(trimesh.Trimesh(cube.vertices, cube.faces[2:], process=False), name="cube", close="all")
    assert closed_by_trimesh(mesh)
    assert mesh.volume == pytest.approx(1)
    assert (report.holes, report.watertight_before, report.watertight) == (1, False, True)
    assert report.volume_before is None


def test_inverted_cube_is_turned(cube):
    mesh, report = repair(trimesh.Trimesh(cube.vertices, cube.faces[:, ::-1], process=False), name="cube")
    assert mesh.volume == pytest.approx(1)
    assert report.inverted_components == 1
    assert report.volume_before == pytest.approx(-1)


def test_one_flipped_face_is_turned(cube):
    faces = cube.faces.copy()
    faces[3] = faces[3, ::-1]
    mesh, report = repair(trimesh.Trimesh(cube.vertices, faces, process=False), name="cube")
    assert closed_by_trimesh(mesh)
    assert mesh.volume == pytest.approx(1)
    assert report.inconsistent_winding


def test_unmerged_triangles_are_joined(cube):
    soup = trimesh.Trimesh(cube.triangles.reshape(-1, 3), np.arange(36).reshape(-1, 3), process=False)
    mesh, report = repair(soup, name="soup")
    assert closed_by_trimesh(mesh)
    assert len(mesh.vertices) == 8
    assert not report.changed


@pytest.mark.parametrize("width", [1e-12, 1e-8, 1e-7])
def test_a_seam_is_joined(width):
    """Vertices that are off by a share of the size change the volume by no more than that share of three."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    mesh = trimesh.Trimesh(*with_a_seam(ball.vertices, ball.faces, width), process=False)
    mended, report = repair(mesh, name="ball")
    assert closed_by_trimesh(mended)
    assert len(mended.faces) == len(ball.faces)
    assert mended.volume == pytest.approx(ball.volume, rel=6 * width, abs=0)
    assert (report.holes, report.components_before, report.self_intersecting_faces) == (0, 1, 0)
    assert report.seams > 0
    assert any("across seams" in line for line in report.lines())


def test_a_seam_in_the_single_precision_of_stl_is_joined(tmp_path):
    """A file of triangles each of which is rounded by itself."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    corners = ball.triangles * (1 + np.random.default_rng(3).uniform(-1e-7, 1e-7, ball.triangles.shape))
    path = tmp_path / "ball.stl"
    trimesh.Trimesh(corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3), process=False).export(path)
    mesh, report = load_mesh(MeshFile(type="mesh", file="ball.stl"), path)
    assert closed_by_trimesh(mesh)
    assert (len(mesh.vertices), report.holes) == (len(ball.vertices), 0)
    assert mesh.volume == pytest.approx(ball.volume, rel=1e-6)


def test_a_gap_is_no_seam():
    """A thousandth of the size is there on purpose, or a hole to mend."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    assert (
        cleaned(trimesh.Trimesh(*with_a_seam(ball.vertices, ball.faces, 1e-3), process=False), name="ball")[1].seams
        == 0
    )


def test_repeated_and_degenerate_faces_go(cube):
    faces = np.vstack([cube.faces, cube.faces[:1], [[0, 0, 1]]])
    mesh, report = repair(trimesh.Trimesh(cube.vertices, faces, process=False), name="cube")
    assert report.degenerate_faces == 2
    assert mesh.volume == pytest.approx(1)


@pytest.mark.parametrize("opened", [False, True])
def test_every_piece_with_a_volume_is_kept(two_cubes, opened):
    """MeshFix alone keeps the largest piece only; the smaller cube has 1/8 of the volume."""
    mesh = two_cubes([3, 0, 0], scale=0.5)
    opened = trimesh.Trimesh(mesh.vertices, mesh.faces[2 * opened :], process=False)
    mended, report = repair(opened, name="two", close="all")
    assert mended.volume == pytest.approx(1 + 0.5**3)
    assert report.components_after == 2
    assert report.components_dropped == 0


def test_intersecting_pieces_are_united(two_cubes):
    """They share 0.5 x 0.6 x 0.7."""
    mended, report = repair(two_cubes([0.5, 0.4, 0.3]), name="two")
    assert closed_by_trimesh(mended)
    assert mended.volume == pytest.approx(2 - 0.5 * 0.6 * 0.7, rel=1e-12)
    assert (report.self_intersecting_faces, report.pieces_united, report.components_after) == (0, 2, 1)
    assert "united 2 pieces, which overlap" in report.lines()


@pytest.mark.parametrize("whole_inverted", [False, True])
def test_hollow_is_kept(two_cubes, whole_inverted):
    mesh = two_cubes([0, 0, 0], scale=0.5, inverted=True)
    if whole_inverted:
        mesh.invert()
    mended, report = repair(mesh, name="hollow")
    assert mended.volume == pytest.approx(1 - 0.5**3)
    assert report.cavities == 1


def test_piece_inside_another_adds_nothing(two_cubes):
    mended, report = repair(two_cubes([0, 0, 0], scale=0.5), name="nested")
    assert mended.volume == pytest.approx(1)
    assert report.components_dropped == 1


def test_repair_does_not_depend_on_size_or_place(cube):
    for scale, offset in ((1e-4, 0.0), (1e4, 0.0), (1.0, 1e4)):
        broken = trimesh.Trimesh(cube.vertices * scale + offset, cube.faces[2:], process=False)
        mended, _ = repair(broken, name="cube", close="all")
        assert mended.volume == pytest.approx(scale**3, rel=1e-6)


def flat_grid():
    i, j = (index.ravel() for index in np.meshgrid(np.arange(3), np.arange(3), indexing="ij"))
    corner = 4 * i + j
    faces = np.vstack(
        [np.column_stack([corner, corner + 1, corner + 5]), np.column_stack([corner, corner + 5, corner + 4])]
    )
    x, z = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    return np.column_stack([x.ravel(), np.zeros(16), z.ravel()]), faces


TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("vertices", "faces", "says"),
    [
        ([[0, 0, np.nan], *TRIANGLE[1:]], [[0, 1, 2]], "not finite"),
        ([[0, 0, np.inf], *TRIANGLE[1:]], [[0, 1, 2]], "not finite"),
        (np.zeros((0, 3)), np.zeros((0, 3), dtype=int), "no faces"),
        (TRIANGLE, np.zeros((0, 3), dtype=int), "no faces"),
        (TRIANGLE, [[0, 1, 3]], "do not exist"),
        (TRIANGLE, [[0, 1, -1]], "do not exist"),
        (TRIANGLE, [[0, 1, 1]], "no face with an area"),
        (TRIANGLE, [[0, 1, 2]], "is flat"),
        (*flat_grid(), "is flat"),
        (np.multiply(TRIANGLE, 1e200), [[0, 1, 2]], "overflow"),
    ],
)
def test_what_encloses_no_volume_is_refused(vertices, faces, says):
    mesh = trimesh.Trimesh(vertices, faces, process=False, validate=False)
    with pytest.raises(Refused, match=says) as refused:
        repair(mesh, name="cup.obj")
    assert "'cup.obj'" in refused.value.message
    assert refused.value.remedy


def test_repair_that_loses_most_of_the_surface_is_refused(cube):
    """The sheet has 30 x 30, the cube below it 6 of area."""
    vertices, faces = flat_grid()
    mesh = trimesh.Trimesh(
        np.vstack([cube.vertices, 10 * vertices + [0, 5, 0]]), np.vstack([cube.faces, faces + 8]), process=False
    )
    with pytest.raises(Refused, match="99 % taken away with 1 of 2 pieces"):
        repair(mesh, name="cube")


def test_mesh_without_repair_must_be_closed(tmp_path, cube):
    path = tmp_path / "open.ply"
    trimesh.Trimesh(cube.vertices, cube.faces[2:], process=False).export(path)
    with pytest.raises(Refused, match="4 open edges") as refused:
        load_mesh(MeshFile(type="mesh", file="open.ply", repair=False), path)
    assert "repair: true" in refused.value.remedy
    sheet, report = load_mesh(MeshFile(type="mesh", file="open.ply"), path, closed=False)
    assert report is None
    assert len(sheet.faces) == 10
