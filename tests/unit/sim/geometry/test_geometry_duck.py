"""The rubber duck of the scenes: its script and its mesh agree, it is a sound solid, and it floats upright."""

import runpy
from pathlib import Path

import numpy as np
import pytest
import trimesh

from sim.geometry.meshes.topology import Topology, components, signed_volume
from sim.geometry.pose import Pose
from sim.geometry.solids import MeshSolid

MODELS = Path(__file__).resolve().parents[4] / "scenes" / "models"
SPACING = 0.0123


@pytest.fixture(scope="module")
def duck():
    return trimesh.load_mesh(MODELS / "duck.ply", process=False)


@pytest.fixture(scope="module")
def script():
    return runpy.run_path(str(MODELS / "duck.py"))


def test_the_script_makes_the_mesh_that_lies_beside_it(duck, script, tmp_path):
    script["main"](["--out", str(tmp_path / "duck.ply")])
    again = trimesh.load_mesh(tmp_path / "duck.ply", process=False)
    assert (again.faces == duck.faces).all()
    assert again.vertices == pytest.approx(duck.vertices, abs=1e-5)
    assert (again.visual.vertex_colors == duck.visual.vertex_colors).all()


def test_it_is_one_closed_piece_that_faces_outward(duck):
    topology = Topology.of(duck)
    assert topology.watertight
    assert topology.consistent
    assert signed_volume(duck) > 0
    assert components(duck)[1] == 1
    assert 5000 < len(duck.faces) < 10000
    assert np.rad2deg(duck.face_angles.min()) > 10


def test_it_is_of_unit_length_around_its_centre_of_volume(duck):
    assert np.ptp(duck.vertices, axis=0).max() == pytest.approx(1)
    assert np.ptp(duck.vertices[:, 2]) == pytest.approx(1)
    assert duck.center_mass == pytest.approx([0, 0, 0], abs=1e-6)


def test_left_and_right_are_alike(duck):
    def sorted_rows(vertices):
        return vertices[np.lexsort(np.round(vertices, 6).T)]

    assert sorted_rows(duck.vertices * [-1, 1, 1]) == pytest.approx(sorted_rows(duck.vertices), abs=1e-6)


def test_beak_and_eyes_have_colours_of_their_own(duck, script):
    colours = duck.visual.vertex_colors[:, :3]
    yellow, orange, black = (
        duck.vertices[(colours == script[name]).all(axis=1)] for name in ("YELLOW", "ORANGE", "BLACK")
    )
    assert len(yellow) + len(orange) + len(black) == len(duck.vertices)
    assert orange[:, 2].mean() > 0.3
    assert black[:, 1].min() > orange[:, 1].mean()


@pytest.mark.parametrize("density", [0.1, 0.2, 0.3, 0.4, 0.5])
@pytest.mark.parametrize("axis", [[0, 0, 1], [1, 0, 0]], ids=["roll", "pitch"])
def test_it_floats_upright(inside, axis, density):
    """Tilted a little further, its buoyancy moves to where it turns it back; densities are over that of water."""
    there, back = (_centre_of_buoyancy(inside, density, axis, np.deg2rad(tilt)) for tilt in (2, -2))
    assert np.dot(axis, np.cross(there - back, [0, 1, 0])) < 0


@pytest.mark.parametrize("density", [0.1, 0.2, 0.3, 0.4])
def test_it_floats_level(inside, density):
    bow_up, bow_down = (_centre_of_buoyancy(inside, density, [1, 0, 0], np.deg2rad(tilt))[2] for tilt in (-2, 2))
    assert bow_up < 0 < bow_down


@pytest.fixture(scope="module")
def inside(duck):
    """Points of a lattice that fill the duck."""
    solid = MeshSolid(Pose(), duck)
    low, size = duck.bounds[0], np.ptp(duck.bounds, axis=0)
    number = np.ceil(size / SPACING).astype(int)
    return low + SPACING * np.argwhere(solid.contains_lattice(low, SPACING, tuple(number)))


def _centre_of_buoyancy(points, density, axis, tilt):
    """Where it floats freely, tilted [rad] about an axis through its centre of mass, the origin."""
    tilted = points @ trimesh.transformations.rotation_matrix(tilt, axis)[:3, :3].T
    return tilted[tilted[:, 1] < np.quantile(tilted[:, 1], density)].mean(axis=0)
