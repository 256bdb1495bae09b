"""The basin in which the bunny stands: its script and its mesh agree, it holds water, and its wall is thick enough."""

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


@pytest.fixture(scope="module")
def basin():
    return trimesh.load_mesh(MODELS / "basin.ply", process=False)


@pytest.fixture(scope="module")
def script():
    return runpy.run_path(str(MODELS / "basin.py"))


@pytest.fixture(scope="module")
def scene():
    return load(SCENES / "bunny.yaml", quality="standard").simulation


def test_the_script_makes_the_mesh_that_lies_beside_it(basin, script, tmp_path):
    script["main"](["--out", str(tmp_path)])
    again = trimesh.load_mesh(tmp_path / "basin.ply", process=False)
    assert (again.faces == basin.faces).all()
    assert again.vertices == pytest.approx(basin.vertices, abs=1e-6)


def test_it_is_one_closed_piece_that_faces_outward(basin):
    topology = Topology.of(basin)
    assert topology.watertight
    assert topology.consistent
    assert signed_volume(basin) > 0
    assert components(basin)[1] == 1
    assert np.rad2deg(basin.face_angles.min()) > 4


def test_it_stands_on_the_ground_of_the_scene_with_its_floor_at_the_origin(basin, scene):
    assert basin.bounds[0, 1] == pytest.approx(scene.rigid.bodies["floor"].position[1])
    inside = np.linalg.norm(basin.vertices[:, [0, 2]], axis=1) < 1.5
    assert set(basin.vertices[inside, 1].round(6)) == {round(basin.bounds[0, 1], 6), 0.0}


def test_its_water_ends_inside_the_wall_and_below_the_coping(basin, scene):
    pool = scene.fluid.bodies["pool"]
    level = pool.position[1] + pool.shape.height / 2
    side = np.array([[pool.shape.radius, height, 0] for height in np.linspace(0.02, level, 9)])
    assert pool.position[1] == pytest.approx(pool.shape.height / 2)
    assert MeshSolid(Pose(), basin).contains(side).all()
    assert level < basin.bounds[1, 1] / 2


def test_its_wall_is_thick_beside_particles(script, scene):
    outside = script["profile"]()[:, 0].max() - script["WALL"]
    thinnest = outside - script["FLOOR"] - script["HOLLOW"]
    assert thinnest > 3 * 2 * scene.fluid.particle_radius
