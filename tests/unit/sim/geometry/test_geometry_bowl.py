"""The bowl of the scenes: its script and its meshes agree, it holds water, and no wall is too thin for particles."""

import runpy
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scene.load import load
from sim.geometry.meshes.topology import Topology, components, signed_volume
from sim.geometry.pose import Pose
from sim.geometry.solids import MeshSolid

SCENES = Path(__file__).resolve().parents[4] / "scenes"
MODELS = SCENES / "models"
NAMES = ("bowl", "water")


@pytest.fixture(scope="module")
def meshes():
    return {name: trimesh.load_mesh(MODELS / f"{name}.ply", process=False) for name in NAMES}


@pytest.fixture(scope="module")
def script():
    return runpy.run_path(str(MODELS / "bowl.py"))


def test_the_script_makes_the_meshes_that_lie_beside_it(meshes, script, tmp_path):
    script["main"](["--out", str(tmp_path)])
    for name in NAMES:
        again = trimesh.load_mesh(tmp_path / f"{name}.ply", process=False)
        assert (again.faces == meshes[name].faces).all()
        assert again.vertices == pytest.approx(meshes[name].vertices, abs=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_each_is_one_closed_piece_that_faces_outward(meshes, name):
    topology = Topology.of(meshes[name])
    assert topology.watertight
    assert topology.consistent
    assert signed_volume(meshes[name]) > 0
    assert components(meshes[name])[1] == 1
    assert np.rad2deg(meshes[name].face_angles.min()) > 4


def test_it_is_one_wide_and_stands_around_its_axis(meshes):
    low, high = meshes["bowl"].bounds
    assert high - low == pytest.approx([1, high[1] - low[1], 1], abs=1e-6)
    assert high[1] == pytest.approx(0.1)
    assert meshes["bowl"].center_mass[[0, 2]] == pytest.approx([0, 0], abs=1e-6)


def test_the_water_ends_inside_the_wall_and_below_the_lip(meshes):
    """So that particles fill the bowl to its wall, and none starts outside."""
    bowl, water = MeshSolid(Pose(), meshes["bowl"]), meshes["water"]
    level = water.bounds[1, 1]
    side = water.vertices[water.vertices[:, 1] < level - 1e-6]
    assert bowl.contains(side).all()
    assert level < 0.1 - 0.05


def test_its_wall_is_nowhere_thinner_than_said(meshes, script):
    """Around the middle of the wall there is half of it on either side, but for the flatness of the triangles."""
    radius, height = script["wall"](0, steps=200).T
    for turn in np.deg2rad([0, 1, 2.25, 50]):
        middle = np.stack([radius * np.sin(turn), height, radius * np.cos(turn)], axis=1)
        depth = -MeshSolid(Pose(), meshes["bowl"]).signed_distance(middle)
        assert depth.min() > 0.95 * script["THICKNESS"] / 2


def test_its_wall_is_thick_beside_particles(script):
    scene = load(SCENES / "bowl.yaml", quality="standard").simulation
    spacing = 2 * scene.fluid.particle_radius
    assert script["THICKNESS"] * scene.rigid.bodies["bowl"].scale > 2.5 * spacing
