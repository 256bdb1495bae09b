"""Shells of a thickness around surfaces: closed forms of volume and mass, inside and outside, and what has none."""

import numpy as np
import pytest
import trimesh
from pydantic import ValidationError

from scene.settings import Refused
from sim.geometry.meshes.shell import thickened
from sim.geometry.meshes.topology import Topology
from sim.geometry.meshes.union import united
from sim.geometry.shapes import place
from sim.geometry.spec import MeshFile, Placement
from tests.support.meshes import write
from tests.support.surfaces import bowl, tray

THICKNESS = 0.1


def sound(mesh):
    topology = Topology.of(mesh)
    return topology.watertight and topology.consistent


def placed(path, mesh, placement=None, **settings):
    write(path, mesh)
    shape = MeshFile(type="mesh", file=path.name, thickness=THICKNESS, **settings)
    return place(shape, placement or Placement(), path.parent)


def tray_volume(thickness, a=2.0, h=1.0, c=3.0):
    """Half of the thickness on either side of four walls and a floor, which end at the rim."""
    return (a + thickness) * (c + thickness) * (h + thickness / 2) - (a - thickness) * (c - thickness) * (
        h - thickness / 2
    )


@pytest.mark.parametrize("turned", ["none", "all", "some"])
def test_a_tray_is_exact_whichever_way_its_faces_look(turned):
    mesh = tray()
    row = {"none": [], "all": slice(None), "some": slice(None, None, 2)}[turned]
    faces = mesh.faces.copy()
    faces[row] = faces[row][:, ::-1]
    shell = thickened(trimesh.Trimesh(mesh.vertices, faces, process=False), THICKNESS)
    assert sound(shell)
    assert shell.volume == pytest.approx(tray_volume(THICKNESS), rel=1e-12)
    half = THICKNESS / 2
    np.testing.assert_allclose(shell.bounds, [[-1 - half, -0.5 - half, -1.5 - half], [1 + half, 0.5, 1.5 + half]])


def half_shell_mass(inner, outer):
    """Volume, centre of mass below the rim, and moments about the axis and across it through the centre of the sphere,
    over the density."""
    volume = 2 * np.pi / 3 * (outer**3 - inner**3)
    centre = np.pi / 4 * (outer**4 - inner**4) / volume
    about_axis = 4 * np.pi / 15 * (outer**5 - inner**5)
    return volume, centre, about_axis, about_axis


def test_a_bowl_has_the_mass_of_its_shell(tmp_path):
    """Not of what fills it, whose centre is 3/8 of the radius below the rim. The chords of the 96-gon are 5.4e-4 of the
    radius off, those of the quarter circle likewise."""
    solid = placed(tmp_path / "bowl.off", bowl())
    volume, centre, about, across = half_shell_mass(1 - THICKNESS / 2, 1 + THICKNESS / 2)
    found = solid.mass_properties(500.0)
    chords = 3e-3
    assert found.mass == pytest.approx(500 * volume, rel=chords)
    np.testing.assert_allclose(found.centre, [0, -centre, 0], atol=chords)
    through = across - volume * centre**2
    np.testing.assert_allclose(np.diag(found.inertia), 500 * np.array([through, about, through]), rtol=2 * chords)


def test_the_inside_of_a_bowl_is_outside_of_its_shell(tmp_path, random):
    solid = placed(tmp_path / "bowl.off", bowl())
    points = random.uniform(-1.2, 1.2, (20_000, 3))
    radius, clear = np.linalg.norm(points, axis=1), 2e-3
    below = points[:, 1] < -clear
    inside = below & (np.abs(radius - 1) < THICKNESS / 2 - clear)
    outside = (points[:, 1] > clear) | (np.abs(radius - 1) > THICKNESS / 2 + clear)
    assert inside.sum() > 100
    found = solid.contains(points)
    assert found[inside].all()
    assert not found[outside].any()
    # From the middle of the bowl it is as far to the shell as to its inner side.
    assert solid.signed_distance(np.zeros((1, 3)))[0] == pytest.approx(1 - THICKNESS / 2, abs=clear)


def test_a_closed_surface_is_hollow(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=4)
    solid = placed(tmp_path / "ball.off", ball)
    assert not solid.contains(np.zeros((1, 3)))[0]
    # The faces of an icosphere of four halvings are within 1.8e-3 of the sphere.
    assert solid.volume == pytest.approx(4 / 3 * np.pi * (1.05**3 - 0.95**3), rel=4e-3)


def test_walls_that_branch_fill_their_corner_once():
    """Three half-planes from one edge: a T of thickness t has t (2 + 1 - t / 2) over its length."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0.0]])
    vertices = np.vstack((vertices, vertices + np.array([0, 0, 1])))
    faces = [face for end in (1, 2, 3) for face in ([0, 4, end + 4], [0, end + 4, end])]
    shell = thickened(trimesh.Trimesh(vertices, faces, process=False), THICKNESS)
    assert sound(shell)
    assert shell.volume == pytest.approx(THICKNESS * (3 - THICKNESS / 2), rel=1e-12)


def test_a_surface_with_one_side_has_a_shell():
    """A Moebius strip: to the square of the bend of its faces, area times thickness."""
    turn, across = np.linspace(0, 2 * np.pi, 200, endpoint=False), np.linspace(-0.3, 0.3, 7)
    u, w = np.meshgrid(turn, across, indexing="ij")
    radius = 1 + w * np.cos(u / 2)
    vertices = np.stack((radius * np.cos(u), radius * np.sin(u), w * np.sin(u / 2)), axis=-1).reshape(-1, 3)
    index = np.arange(u.size).reshape(u.shape)
    ahead = np.vstack((index[1:], index[:1, ::-1]))
    quads = np.stack((index[:, :-1], index[:, 1:], ahead[:, 1:], ahead[:, :-1]), axis=-1).reshape(-1, 4)
    strip = trimesh.Trimesh(vertices, np.concatenate((quads[:, [0, 1, 2]], quads[:, [0, 2, 3]])), process=False)
    shell = thickened(strip, 0.05)
    assert sound(shell)
    assert shell.volume == pytest.approx(strip.area * 0.05, rel=5e-3)


def test_walls_thicker_than_what_is_between_them_meet():
    """The inner sides of a tray 1 wide pass through each other: what is left is a block."""
    thickness = 1.2
    shell = united(thickened(tray((2, 1, 1)), thickness))
    assert sound(shell)
    assert shell.volume == pytest.approx((2 + thickness) * (1 + thickness / 2) * (1 + thickness), rel=1e-12)


def test_size_is_that_of_the_surface_and_scale_scales_the_thickness(tmp_path):
    """A tray of 2 x 1 x 3 at size 6, a shell of 0.1, all twice as large, stands with its outer side on the ground."""
    solid = placed(tmp_path / "tray.off", tray(), Placement(scale=2), size=6, anchor="base")
    assert solid.volume == pytest.approx(8 * tray_volume(THICKNESS, 4, 2, 6), rel=1e-9)
    np.testing.assert_allclose(solid.bounds, [[-4.1, 0, -6.1], [4.1, 4.1, 6.1]], atol=1e-12)


def test_colours_stay(tmp_path):
    mesh = tray()
    mesh.visual.vertex_colors = np.where(mesh.vertices[:, :1] > 0, [[255, 0, 0, 255]], [[0, 0, 255, 255]])
    mesh.export(tmp_path / "tray.ply")
    solid = place(MeshFile(type="mesh", file="tray.ply", thickness=THICKNESS), Placement(), tmp_path)
    colors, side = solid.mesh.visual.vertex_colors, solid.mesh.vertices[:, 0] > 0
    assert (colors[side] == [255, 0, 0, 255]).all()
    assert (colors[~side] == [0, 0, 255, 255]).all()


def test_triangles_of_any_kind_have_a_closed_shell(random):
    """Fins, fans, folds, cones, edges of many faces: every edge of the shell has two faces, one in each direction."""
    for _ in range(300):
        faces = random.integers(0, 6, (random.integers(1, 9), 3))
        faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
        _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
        if len(first):
            mesh = trimesh.Trimesh(random.uniform(-1, 1, (6, 3)), faces[first], process=False)
            assert sound(thickened(mesh, 0.01)), faces[first].tolist()


def test_a_fin_on_an_edge_of_a_solid_has_a_shell():
    """Its front and its back are one with the outside of the solid at both ends of the edge."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 2, 0], [0, 0, 1.0]])
    faces = [[1, 0, 4], [2, 4, 1], [2, 4, 0], [1, 0, 2], [4, 2, 3]]
    assert sound(thickened(trimesh.Trimesh(vertices, faces, process=False), 0.01))


def test_a_line_has_no_shell(tmp_path):
    with pytest.raises(Refused, match="have no area") as refused:
        placed(tmp_path / "line.off", trimesh.Trimesh([[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 1, 2]], process=False))
    assert refused.value.location == ("shape", "file")


def test_a_shell_is_not_closed():
    with pytest.raises(ValidationError, match="leave out thickness or close"):
        MeshFile(type="mesh", file="bowl.off", thickness=0.1, close="all")


@pytest.mark.parametrize("group", ["containers", "cloth"])
def test_neither_containers_nor_cloth_have_a_thickness(group):
    """The fluid of a mesh container is inside its surface; a sheet of cloth is the surface."""
    from sim.spec import SimulationSpec

    shape = {"type": "mesh", "file": "bowl.off", "thickness": 0.1}
    scene = {
        "containers": {"containers": {"bowl": {"type": "mesh", "shape": shape}}},
        "cloth": {"cloth": {"sheets": {"bowl": {"shape": shape}}}},
    }[group]
    with pytest.raises(ValidationError, match="thickness"):
        SimulationSpec.model_validate({"fps": 24, **scene})
