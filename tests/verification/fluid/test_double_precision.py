"""`precision: double`: what holds to rounding holds to that of doubles, states keep them, files for others do not.

Every run is a process of its own: kernels carry their type from the moment they are defined.
"""

from __future__ import annotations

import json
import subprocess

import numpy as np
import pytest

from tests.stress.scenes import ROOT, THICK, assert_nothing_broken, contents, environment, pool, segment_command
from tests.support.fluid.solvers import SOLVERS, steps
from tests.support.particles import read_frame

EPS = float(np.finfo(np.float64).eps)
QUICK = "wcsph"
BY_SOLVER = [pytest.param(name, marks=() if name == QUICK else pytest.mark.slow) for name in SOLVERS]
DOWN = [{"axis": [1, 0, 0], "angle": 180}]
EVERYTHING = THICK | {
    "fluid__emitters": {
        "tap": {"shape": {"type": "disc", "radius": 0.07}, "position": [0, 0.38, 0], "rotation": DOWN, "speed": 1.0}
    },
    "fluid__drains": {"sink": {"shape": {"type": "box", "size": [0.1, 0.06, 0.4]}, "position": [0.15, 0.03, 0]}},
    "rigid__bodies": {
        "plate": {
            "shape": {"type": "box", "size": [0.2, 0.08, 0.2]},
            "position": [-0.1, 0.06, 0],
            "motion": "prescribed",
            "velocity": [0.2, 0, 0],
        }
    },
}


def simulate(scene, out, frames, *options):
    """The folder of a run in double precision, in a process of its own."""
    command = segment_command(scene | {"precision": "double"}, out, frames, "--threads", 1, *options)
    done = subprocess.run(command, cwd=ROOT, env=environment(), capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert_nothing_broken(out)
    return out


def state(out, frame):
    """Positions [m], relative to the origin, and velocities [m/s] after a frame, shape [n, 3], by identity."""
    with np.load(out / f"state_{frame:05d}.npz") as stored:
        arrays = dict(stored)
    for name in ("position", "velocity", "acceleration"):
        assert arrays[f"fluid.{name}"].dtype == np.float64
    order = np.argsort(arrays["fluid.tag"][:, 0])
    return arrays["fluid.position"][order, :3], arrays["fluid.velocity"][order, :3]


@pytest.mark.parametrize("solver", BY_SOLVER)
def test_free_fall_to_double_rounding(tmp_path, solver):
    """x = v0 t + g t^2 / 2. In every step coordinates and speeds below 4 are rounded a few times, by half a unit in the
    last place each time."""
    g, v0, t, dt = np.array([0.3, -9.81, 0.0]), np.array([0.5, 2.0, -1.0]), 0.125, 2.0**-11
    cube = {"shape": {"type": "box", "size": [0.1] * 3}, "position": [0, 1.5, 0], "velocity": v0.tolist()}
    fluid = {"solver": solver, "particle_radius": 0.01, "bodies": {"cube": cube}}
    scene = {"fps": 8, "gravity": g.tolist(), "step": {"fixed": dt / 4 if solver == "wcsph" else dt}, "fluid": fluid}
    start, end = simulate(scene, tmp_path / "start", "0:0"), simulate(scene, tmp_path / "end", "0:1")
    (x0, _), (x1, v1) = state(start, 0), state(end, 1)
    rounding = 4 * len(steps(end)) * np.spacing(2.0)
    np.testing.assert_allclose((x1 - x0).mean(axis=0), v0 * t + g * t * t / 2, rtol=0, atol=rounding)
    np.testing.assert_allclose(v1.mean(axis=0), v0 + g * t, rtol=0, atol=rounding)
    assert rounding < 1e-11


@pytest.mark.parametrize("solver", BY_SOLVER)
def test_a_collision_keeps_the_momentum_to_double_rounding(tmp_path, solver):
    """Pair forces are equal and opposite but for the rounding of some 50 terms a particle and step."""
    ball = {"type": "sphere", "radius": 0.06}
    bodies = {
        "left": {"shape": ball, "position": [-0.08, 0, 0], "velocity": [1.0, 0.2, 0]},
        "right": {"shape": ball, "position": [0.08, 0.03, 0.02], "velocity": [-0.5, 0, 0.1]},
    }
    fluid = {"solver": solver, "particle_radius": 0.012, "viscosity": 1e-3, "bodies": bodies}
    scene = {"fps": 20, "gravity": [0, 0, 0], "fluid": fluid}
    start, end = simulate(scene, tmp_path / "start", "0:0"), simulate(scene, tmp_path / "end", "0:3")
    first, last = state(start, 0)[1], state(end, 3)[1]
    assert np.abs(first - last).max() > 0.3, "the drops did not collide"
    scale = np.linalg.norm(first, axis=1).sum()
    bound = 50 * EPS * len(steps(end))
    assert bound < 1e-10
    assert np.linalg.norm(last.sum(axis=0) - first.sum(axis=0)) < bound * scale


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_all_features_resume_to_the_byte(tmp_path, solver):
    """Emitters, drains, a body that moves, implicit viscosity, tension, adhesion and XSPH; a state holds doubles."""
    scene = pool(fluid__solver=solver, **EVERYTHING)
    whole = simulate(scene, tmp_path / "whole", "0:6")
    first = simulate(scene, tmp_path / "first", "0:3")
    second = simulate(scene, tmp_path / "second", "4:6", "--resume", first / "state_00003.npz")
    assert contents(second, "state_00006.npz") == contents(whole, "state_00006.npz")
    assert contents(first, "fluid_*.ply") | contents(second, "fluid_*.ply") == contents(whole, "fluid_*.ply")
    assert all(read_frame(whole, 6)[name].dtype == np.float32 for name in ("x", "vx", "density"))
    assert json.loads((whole / "summary.json").read_text())["counts"]["particles_emitted"] > 0


def test_a_state_of_the_other_precision_is_refused(tmp_path):
    kept = simulate(pool(), tmp_path / "double", "0:0") / "state_00000.npz"
    command = segment_command(pool(), tmp_path / "single", "1:1", "--resume", kept)
    done = subprocess.run(command, cwd=ROOT, env=environment(), capture_output=True, text=True, timeout=600)
    assert done.returncode == 2
    assert "'precision': 'double'" in done.stderr
