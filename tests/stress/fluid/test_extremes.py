"""Whatever the scene: right within a bound, refused before the first step, or stopped with the last good state.

Never a value that is not finite in a file, never a hang, never success after a failure.
"""

from __future__ import annotations

import time

import numpy as np
import pytest
import trimesh

from scene.settings import Refused
from sim.run.failure import MOST_STEPS
from tests.stress.scenes import assert_nothing_broken, pool
from tests.support.particles import positions, read_frame, read_table, velocities

LIMIT = 120.0
"""Seconds after which a scene of 125 particles hangs: most take one, and one with a mesh 20 where its kernels have to
be compiled, on a machine that does nothing else."""
WATER = pool()["fluid"]["bodies"]["water"]


def scaled(factor: float, **changes):
    """The pool in another size; frames as far apart as falling takes."""
    return pool(
        fps=100 / factor**0.5,
        containers__tank__size=[0.4 * factor] * 3,
        fluid__particle_radius=0.02 * factor,
        fluid__bodies__water={
            "shape": {"type": "box", "size": [0.2 * factor] * 3},
            "position": [0, 0.15 * factor, 0],
        },
        **changes,
    )


RIGHT = {
    "no gravity": pool(gravity=[0, 0, 0]),
    "strong gravity": pool(gravity=[0, -1e4, 0], fps=1000),
    "gravity up": pool(gravity=[0, 9.81, 0]),
    "gravity sideways": pool(gravity=[9.81, 0, 0]),
    "tilted gravity": pool(gravity=[5, -7, 3]),
    "light": pool(fluid__rest_density=1),
    "lightest": pool(fluid__rest_density=1e-3),
    "heavy": pool(fluid__rest_density=20_000),
    "heaviest": pool(fluid__rest_density=1e6),
    "inviscid": pool(fluid__viscosity=0),
    "honey": pool(fluid__viscosity=1),
    "pitch": pool(fluid__viscosity=1e4),
    "hardest pitch": pool(fluid__viscosity=1e6, fluid__solver="dfsph"),
    "small support": pool(fluid__support_ratio=3),
    "large support": pool(fluid__support_ratio=6),
    "surface tension": pool(fluid__surface_tension=50),
    "surface tension of both terms": pool(fluid__surface_tension=50, fluid__surface_tension_model="akinci2013"),
    "adhesion": pool(fluid__adhesion=50),
    "fast": pool(fluid__bodies__water__velocity=[100, 0, 0], fps=1000),
    "one particle": pool(fluid__bodies__water__shape__size=[0.04] * 3),
    "10 micrometres": scaled(5e-4),
    "10 metres": scaled(500),
    "corner": pool(fluid__bodies__water__position=[-0.1, 0.1, -0.1]),
    "half inside a solid": pool(
        rigid__bodies={
            "ball": {"motion": "static", "shape": {"type": "sphere", "radius": 0.1}, "position": [0.1, 0.1, 0]}
        }
    ),
    "long step": pool(step={"cfl": 1}),
}
REFUSED = {
    "no step is short enough": (pool(fluid__bodies__water__velocity=[1e5, 0, 0], fps=10), "fastest signal"),
    "viscosity": (pool(fluid__viscosity=1e4, fluid__viscosity_solver="explicit"), r"the viscosity \(1e\+04"),
    "far away": (
        pool(containers__tank__position=[1e5, 0, 0], fluid__bodies__water__position=[1e5, 0.15, 0]),
        "coarse for particles",
    ),
    "far apart": (
        pool(containers={}, fluid__bodies__other=WATER | {"position": [1e5, 0, 0]}),
        "coarse for particles",
    ),
    "outside": (pool(fluid__bodies__water__position=[9, 9, 9]), "inside the containers"),
    "twice the same": (pool(fluid__bodies__again=WATER), "other fluid"),
    "too many": (pool(fluid__particle_radius=1e-5), "max_particles"),
}
STOPPED = {
    "torn": (pool(fluid__surface_tension=1e5), "sound"),
    "slow sound": (pool(fluid__wcsph={"speed_of_sound": 0.1}), "sound"),
    "gravity comes": (pool(fps=5, events=[{"at": 0.25, "set": {"gravity": [0, -1e6, 0]}}]), f"at most {MOST_STEPS:,}"),
}


@pytest.fixture(autouse=True)
def _in_time():
    began = time.monotonic()
    yield
    assert time.monotonic() - began < LIMIT


def assert_inside(out, size: float, spacing: float) -> None:
    """Not further into a wall than half a spacing (the failure policy itself allows half the support)."""
    x = positions(read_frame(out, 4)) - [0, size / 2, 0]
    assert np.abs(x).max() < size / 2 + spacing / 2


@pytest.mark.outcome("A")
@pytest.mark.parametrize("name", RIGHT)
def test_right(simulate, name):
    scene = RIGHT[name]
    out = simulate(scene, 4, threads=1)
    assert_nothing_broken(out)
    counts = [len(read_frame(out, frame)) for frame in range(5)]
    assert len(set(counts)) == 1
    size, spacing = scene["containers"]["tank"]["size"][0], 2 * scene["fluid"]["particle_radius"]
    assert_inside(out, size, spacing)
    steps = read_table(out / "steps.csv")
    assert steps["density_error_max"].max() < 0.3
    # What is not given as speed or height at the start can only come from fields that do work: tension here.
    if "tension" not in name:
        speed = np.linalg.norm(scene["fluid"]["bodies"]["water"].get("velocity", [0, 0, 0]))
        gravity = np.linalg.norm(scene.get("gravity", [0, -9.81, 0]))
        energy = steps["kinetic_energy"] / steps["n_fluid"] / (scene["fluid"].get("rest_density", 1000) * spacing**3)
        # Positions are rounded, by up to 1e-6 of a spacing, and densities by no larger share: the speed of sound, 100
        # spacings a second at least, makes motion of it.
        rounding = (1e-6 * 100 * spacing) ** 2 / 2
        assert energy.max() <= 1.05 * (speed**2 / 2 + gravity * size) + rounding


@pytest.mark.outcome("B")
@pytest.mark.parametrize("name", REFUSED)
def test_refused(simulate, tmp_path, name):
    scene, message = REFUSED[name]
    with pytest.raises(Refused, match=message) as refused:
        simulate(scene, 4, threads=1)
    assert refused.value.remedy
    assert not (tmp_path / "run").exists() or not list((tmp_path / "run").iterdir())


@pytest.mark.outcome("C")
@pytest.mark.parametrize("name", STOPPED)
def test_stopped(simulate, name):
    scene, message = STOPPED[name]
    out = simulate(scene, 4, threads=1, expect=3)
    assert message in (out / "failure.json").read_text()
    assert list(out.glob("state_*.npz"))
    assert_nothing_broken(out)


@pytest.mark.outcome("A")
def test_sizes_are_similar(simulate):
    """The same scene in another size: lengths scale with s, times with its root (Froude)."""
    scene = {"fluid__viscosity": 0, "fluid__wcsph": {"artificial_viscosity": 0.1}}
    frames = [
        positions(read_frame(simulate(scaled(s, **scene), 4, f"{s:g}", threads=1), 4)) / s for s in (1, 5e-4, 500)
    ]
    # Single precision, and steps that differ by its rounding.
    np.testing.assert_allclose(frames[1], frames[0], atol=2e-4 * 0.4)
    np.testing.assert_allclose(frames[2], frames[0], atol=2e-4 * 0.4)


@pytest.mark.outcome("A")
def test_a_scene_far_from_the_origin_is_the_same_scene(simulate):
    """Coordinates relative to the middle of the scene are exact; only files round to single precision."""
    away = 512.0
    scene = {"fluid__particle_radius": 1 / 64, "containers__tank__size": [0.5] * 3}
    body = {"shape": {"type": "box", "size": [0.1875] * 3}, "velocity": [1, 0, 0.5]}
    near = simulate(pool(**scene, fluid__bodies__water=body | {"position": [0, 0.125, 0]}), 4, "near")
    far_scene = pool(**scene, fluid__bodies__water=body | {"position": [away, 0.125, -away]})
    far_scene["containers"]["tank"]["position"] = [away, 0, -away]
    far = simulate(far_scene, 4, "far")
    with np.load(near / "state_00004.npz") as a, np.load(far / "state_00004.npz") as b:
        for name in ("fluid.position", "fluid.velocity", "fluid.tag"):
            np.testing.assert_array_equal(a[name], b[name])
    moved = positions(read_frame(far, 4)) - positions(read_frame(near, 4))
    np.testing.assert_allclose(moved, np.broadcast_to([away, 0, -away], moved.shape), atol=np.spacing(np.float32(away)))


@pytest.mark.outcome("A")
def test_bodies_that_overlap_are_not_filled_twice(simulate):
    """Half a spacing aside, the second body's points lie in the holes of the first's lattice."""
    both = {"first": WATER, "second": WATER | {"position": [0.08, 0.17, 0.02]}}
    out = simulate(pool(fluid__bodies=both), 2, threads=1)
    points = read_frame(out, 0)
    union = 2 * 0.2**3 - 0.12 * 0.18 * 0.18
    assert len(points) * 0.04**3 < 1.02 * union
    assert points["density"].max() < 1.1 * 1000
    assert_nothing_broken(out)


@pytest.mark.slow
@pytest.mark.outcome("A")
def test_particles_fly_off_without_bound(simulate):
    """No box bounds the scene: x0 + v0 t + g t^2 / 2, far beyond the period of the hash."""
    velocity, seconds = np.array([300.0, 40.0, -200.0]), 4
    body = WATER | {"velocity": velocity.tolist(), "shape": {"type": "box", "size": [2, 2, 2]}}
    large = {"fluid__particle_radius": 1, "fluid__wcsph": {"speed_of_sound": 400}}
    out = simulate(pool(fps=1, containers={}, **large, fluid__bodies__water=body), seconds, threads=1)
    gravity = np.array([0, -9.81, 0])
    x = positions(read_frame(out, seconds))[0]
    expected = np.array(body["position"]) + seconds * velocity + gravity * seconds**2 / 2
    # At worst half a unit in the last place a step for the position, and twice that for the velocity.
    steps = len(read_table(out / "steps.csv"))
    np.testing.assert_allclose(x, expected, atol=steps * np.spacing(np.float32(1200)) / 2)
    final = velocities(read_frame(out, seconds))[0]
    np.testing.assert_allclose(final, velocity + gravity * seconds, atol=steps * np.spacing(np.float32(300)))


@pytest.mark.outcome("A")
@pytest.mark.slow
def test_fluid_stays_in_a_round_container(simulate, tmp_path):
    """The inside of a closed mesh: no particle leaves a sphere."""
    trimesh.creation.icosphere(subdivisions=3, radius=0.2).export(tmp_path / "ball.obj")
    bowl = {"type": "mesh", "shape": {"type": "mesh", "file": "ball.obj"}, "position": [0, 0.2, 0]}
    body = {"shape": {"type": "sphere", "radius": 0.14}, "position": [0.03, 0.22, 0], "velocity": [1, -1, 0]}
    scene = pool(fps=20, containers={"bowl": bowl}, fluid__bodies={"water": body})
    out = simulate(scene, 10, threads=1)
    assert_nothing_broken(out)
    for frame in (0, 2, 5, 10):
        distance = np.linalg.norm(positions(read_frame(out, frame)) - [0, 0.2, 0], axis=1)
        assert np.count_nonzero(distance > 0.2) == 0, f"frame {frame}: {distance.max()}"
