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
    return sampled(names, np.asarray(vertices), places, velocities, {"density": given}, SPACING)


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


@pytest.fixture
def two(tmp_path):
    """A simulation of two blocks side by side, the right one 0.1 s later, in frame 3; returns its folder."""
    places = lattice(6)
    points = np.zeros(len(places), FLUID_POINT)
    for axis, name in enumerate("xyz"):
        points[name] = places[:, axis]
    points["density"] = 1000.0
    points["id"] = np.arange(len(places))
    folder = tmp_path / "simulation"
    folder.mkdir()
    write_points(folder / "fluid_00003.ply", points)
    half = len(places) // 2
    (folder / "sources.csv").write_text(f"id,time,source\n0,0,left\n{half},0.1,right\n")
    return folder


def reconstructed(folder, **spec):
    whole = {"particle_radius": SPACING / 2, "surface": {"attributes": ["age", "source"]}, "fps": 10, **spec}
    command = [sys.executable, "-m", "workflow.reconstruct", "--spec", json.dumps(whole), "--frames", "3:3"]
    command += ["--simulation", str(folder), "--out", str(folder.parent / "surface")]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def test_ages_and_sources_mix_where_fluids_meet(two):
    """0.3 s and 0.2 s, and all of one source, at the ends; in between ages are those of the shares."""
    done = reconstructed(two, sources=["left", "right", "late"])
    assert done.returncode == 0, done.stderr
    found = read_points(two.parent / "surface" / "surface_00003.ply")
    assert found.dtype.names[9:] == ("age", "source_left", "source_right", "source_late")
    left, right = found["source_left"], found["source_right"]
    assert left + right == pytest.approx(1.0, abs=1e-5) and not found["source_late"].any()
    assert found["age"] == pytest.approx(0.3 * left + 0.2 * right, abs=1e-5)
    middle = 2.5 * SPACING
    far = np.abs(found["x"] - middle) > REACH * SPACING + SPACING
    assert left[far] == pytest.approx((found["x"][far] < middle).astype(float), abs=1e-6)
    assert ((left > 0.2) & (left < 0.8)).any()


def test_sources_need_not_be_named(two):
    done = reconstructed(two)
    assert done.returncode == 0, done.stderr
    names = read_points(two.parent / "surface" / "surface_00003.ply").dtype.names
    assert names[9:] == ("age", "source_left", "source_right")


def gone(folder):
    (folder / "sources.csv").unlink()


def later(folder):
    (folder / "sources.csv").write_text("id,time,source\n7,0,left\n")


def mixed_up(folder):
    (folder / "sources.csv").write_text("id,time,source\n7,0,left\n0,0,right\n")


@pytest.mark.parametrize(
    ("damage", "spec", "said"),
    [
        (gone, {}, "sources.csv is missing, which tells when particles came. simulate anew, or leave age and source"),
        (later, {}, "sources.csv is not about all particles"),
        (mixed_up, {}, "rows are not in order"),
        (lambda folder: None, {"sources": ["left"]}, "particles of the simulation come from right, too"),
        (lambda folder: None, {"fps": None}, "age needs the times of the frames: give fps"),
    ],
)
def test_what_cannot_be_told_is_refused(two, damage, spec, said):
    damage(two)
    done = reconstructed(two, **spec)
    assert done.returncode == 2
    assert said in done.stderr.replace("\n  fix: ", ". ")
