"""What the surface of water says of the fluid at its vertices."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial import KDTree

from common.ply import FLUID_POINT, read_points, write_points
from workflow.stages.surface.attributes import REACH, curl, sampled
from workflow.stages.surface.spec import SurfaceSpec

SPACING = 0.1
ALL = ("speed", "vorticity", "density")


def lattice(count: int = 8) -> np.ndarray:
    """A cube of particles, a little out of order."""
    places = SPACING * np.stack(np.meshgrid(*[np.arange(count)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    return places + 0.1 * SPACING * np.random.default_rng(0).uniform(-1, 1, places.shape)


def at(vertices, places, velocities, density=None, names=ALL):
    given = np.full(len(places), 1000.0) if density is None else density
    return sampled(names, np.asarray(vertices), places, velocities, given, SPACING)


def test_vorticity_is_twice_the_rotation_also_at_the_free_surface():
    """Corrected gradients are exact for velocities that are linear: here a rotation and a shear."""
    places, spin, shear = lattice(), np.array([0.3, -2.0, 0.7]), 0.4
    velocities = np.cross(spin, places)
    velocities[:, 0] += shear * places[:, 1]
    found = curl(KDTree(places), velocities, SPACING, np.arange(len(places)))
    assert found == pytest.approx(np.tile(2 * spin - [0, 0, shear], (len(places), 1)), abs=1e-9)
    length = np.linalg.norm(2 * spin - [0, 0, shear])
    near, far = places[:5] + 0.02, places[-1:] + 5 * SPACING
    assert at(np.concatenate([near, far]), places, velocities)["vorticity"] == pytest.approx(length, rel=1e-6)


def test_a_sheet_has_the_rotation_about_its_normal():
    """Nothing is known across one layer of particles, so that nothing is made up there."""
    places = lattice()[:64] * [0, 1, 1]
    found = curl(KDTree(places), np.cross([2.0, 0, 0], places), SPACING, np.arange(64))
    assert found == pytest.approx(np.tile([4.0, 0, 0], (64, 1)), abs=1e-9)


def test_what_is_the_same_everywhere_is_so_at_vertices():
    places = lattice()
    vertices = places[::7] + np.array([0.03, 0, 0])
    found = at(vertices, places, np.tile([0.0, 3.0, 4.0], (len(places), 1)))
    assert found["speed"] == pytest.approx(5.0) and found["speed"].dtype == np.float32
    assert found["vorticity"] == pytest.approx(0.0, abs=1e-9)
    assert found["density"] == pytest.approx(1000.0)


def test_means_lie_between_the_particles_and_near_ones_count_more():
    places = np.array([[0.0, 0, 0], [SPACING, 0, 0]])
    found = at([[0.3 * SPACING, 0, 0]], places, np.zeros((2, 3)), np.array([500.0, 1000.0]))["density"][0]
    weights = [(1 - (away / REACH) ** 2) ** 3 for away in (0.3, 0.7)]
    assert found == pytest.approx((500 * weights[0] + 1000 * weights[1]) / sum(weights), rel=1e-6)


def test_beyond_all_particles_the_nearest_counts():
    places = np.array([[0.0, 0, 0], [1.0, 0, 0]])
    found = at([[1.0 + 3 * SPACING, 0, 0]], places, np.array([[1.0, 0, 0], [2.0, 0, 0]]))
    assert found["speed"] == pytest.approx([2.0])


def test_without_particles_or_names_there_is_nothing():
    nothing = np.zeros((0, 3))
    assert at(nothing, nothing, nothing)["speed"].shape == (0,)
    assert at(lattice(), lattice(), lattice(), names=()) == {}


@pytest.mark.parametrize(
    ("names", "said"), [(["spede"], "'speed'"), (["speed", "density", "speed"], "speed is named twice")]
)
def test_names_that_cannot_be(names, said):
    with pytest.raises(ValidationError, match=said):
        SurfaceSpec.model_validate({"attributes": names})


@pytest.mark.parametrize("names", [(), ("vorticity", "speed")])
def test_files_have_what_is_asked_for_and_no_more(tmp_path, names):
    """By default what they always had."""
    places = lattice(4)
    points = np.zeros(len(places), FLUID_POINT)
    for axis, name in enumerate("xyz"):
        points[name] = places[:, axis]
    points["vx"], points["density"] = 2.0, 1000.0
    (tmp_path / "simulation").mkdir()
    write_points(tmp_path / "simulation" / "fluid_00000.ply", points)
    spec = {"particle_radius": SPACING / 2} | ({"surface": {"attributes": names}} if names else {})
    command = [sys.executable, "-m", "workflow.reconstruct", "--spec", json.dumps(spec), "--frames", "0:0"]
    command += ["--simulation", str(tmp_path / "simulation"), "--out", str(tmp_path / "surface")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    found = read_points(tmp_path / "surface" / "surface_00000.ply")
    assert found.dtype.names == ("x", "y", "z", "nx", "ny", "nz", "vx", "vy", "vz", *names)
    for name, value in (("speed", 2.0), ("vorticity", 0.0)):
        if name in names:
            assert found[name] == pytest.approx(value, abs=1e-5)
