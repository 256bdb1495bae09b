"""What emitters send and drains take, for every pressure solver: volumes, lattices and free fall in closed form."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from sim.fluid.kernel import cubic_host, particle_mass
from sim.geometry.pose import rotation_matrix
from sim.geometry.spec import Rotation
from tests.support.fluid.solvers import LONG, SOLVERS, run, steps
from tests.support.particles import positions, read_frame, velocities

R = 0.01
D = 2 * R
DOWN = [{"axis": [1, 0, 0], "angle": 180}]
ASKEW = [{"axis": [1, 0.3, 0.2], "angle": 77}]
DISC = {"type": "disc", "radius": 2.2 * D}
"""16 particles a layer."""
LAYER = 16


def scene(solver, tap, **others):
    data = {"fps": 10, "fluid": {"solver": solver, "particle_radius": R, "emitters": {"tap": tap}}}
    data["fluid"] |= others.pop("fluid", {})
    return data | others


def counts(out):
    return json.loads((out / "summary.json").read_text())["counts"]


STEPS = {
    "adaptive": {},
    "short": {"cfl": 0.1},
    "fixed": {"fixed": 1.7e-3},
}


@pytest.mark.parametrize("fps", [10, 64])
@pytest.mark.parametrize("step", STEPS)
def test_the_volume_is_rate_times_time(tmp_path, step, fps):
    """V = rate (t - start) in whole layers, at every frame, from nothing; after stop no more."""
    rate, start, stop = 5e-3, 0.0317, 0.2613
    tap = {"shape": DISC, "rotation": ASKEW, "rate": rate, "start": start, "stop": stop}
    out = run(scene("dfsph", tap, fps=fps, step=STEPS[step], gravity=[0, 0, 0]), tmp_path, round(0.3 * fps))
    for frame in range(round(0.3 * fps) + 1):
        time = min(frame / fps, stop)
        layers = math.floor(rate * max(0, time - start) / (LAYER * D**3))
        assert len(read_frame(out, frame)) == LAYER * layers, frame


@pytest.mark.parametrize("solver", SOLVERS)
def test_every_solver_gets_the_same_volume(tmp_path, solver):
    """Also with gravity, which changes steps, and when events change the rate within a frame."""
    events = [
        {"at": 0.123, "set": {"fluid.emitters.tap.speed": 0.3}},
        {"at": 0.161, "set": {"fluid.emitters.tap.speed": 1.1}},
    ]
    tap = {"shape": DISC, "rotation": DOWN, "speed": 0.7}
    out = run(scene(solver, tap, events=events), tmp_path, 3)
    way = 0.7 * 0.123 + 0.3 * (0.161 - 0.123) + 1.1 * (0.3 - 0.161)
    assert counts(out)["particles_emitted"] == len(read_frame(out, 3)) == LAYER * math.floor(way / D)


def stream(out, frame, centre):
    """Positions along the outlet's axes over the spacing, from the back of the first layer's particles, and points."""
    points = read_frame(out, frame)
    turn = rotation_matrix(tuple(Rotation(**turn) for turn in ASKEW))
    return (positions(points) - centre) @ turn / D, velocities(points) @ turn, points


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_stream_in_free_flight_is_a_perfect_lattice(tmp_path, solver):
    """Without gravity nothing acts on it: layer k is at x = v t - (k + 1/2) d, the density that of the lattice.

    A density right within 1 % allows positions that are wrong by 1/3 % of the spacing.
    """
    centre, speed, frame = [0.3, 0.2, 0.1], 1.3, 3
    tap = {"shape": {"type": "disc", "radius": 3.4 * D}, "rotation": ASKEW, "position": centre, "speed": speed}
    x, v, points = stream(run(scene(solver, tap, gravity=[0, 0, 0]), tmp_path, frame), frame, centre)
    layer = speed * frame / 10 / D - 0.5 - x[:, 1]
    np.testing.assert_allclose(layer, np.round(layer), atol=1 / 300)
    # Of an even or odd number of points across: on the middle between them, or on them.
    across = x[:, [0, 2]] - np.round(2 * x[0, [0, 2]]) / 2
    np.testing.assert_allclose(across, np.round(across), atol=1 / 300)
    assert np.array_equal(np.unique(np.round(layer)), np.arange(math.floor(speed * frame / 10 / D)))
    np.testing.assert_allclose(v, np.tile([0, speed, 0], (len(v), 1)), atol=speed / 300)
    # All 33 points of the lattice in the support of h = 2 d.
    inner = np.array([len(near) for near in cKDTree(x).query_ball_point(x, 2.01)]) == 33
    assert inner.sum() > 50
    np.testing.assert_allclose(points["density"][inner], 1000, rtol=0.01)
    assert points["density"].max() < 1010


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_stream_falls_freely(tmp_path, solver):
    """v^2 = v0^2 + 2 g s from the end of the nozzle, one support radius below the outlet, at x = (v^2 - v0^2) / (2 g).

    In the step that takes it out of the nozzle a particle does not fall yet, for a way of v0 dt at most. Between two
    heights there is what flows in the time of the way, in layers.
    """
    g, v0, height, nozzle = 9.81, 0.5, 2.0, 4 * R
    tap = {"shape": DISC, "rotation": DOWN, "position": [0, height, 0], "speed": v0}
    out = run(scene(solver, tap), tmp_path, 5)
    points = read_frame(out, 5)
    fallen, v = height - nozzle - positions(points)[:, 1], velocities(points)
    free = fallen > 0
    assert fallen.max() > 0.9
    squared = v0**2 + 2 * g * fallen[free]
    led = 2 * g * v0 * steps(out)["dt"].max()
    assert (np.abs(v[free, 1] ** 2 - squared) < 1e-3 * squared + led).all()
    np.testing.assert_allclose(v[~free], np.tile([0, -v0, 0], ((~free).sum(), 1)), atol=1e-6)
    assert np.abs(v[:, [0, 2]]).max() < 1e-3 * np.sqrt(squared.max())
    ways = np.array([0.1, 0.4, 0.8])
    times = (np.sqrt(v0**2 + 2 * g * ways) - v0) / g
    for k in range(2):
        found = ((fallen > ways[k]) & (fallen < ways[k + 1])).sum() / LAYER
        assert abs(found - (times[k + 1] - times[k]) * v0 / D) <= 1


@pytest.mark.parametrize("solver", LONG)
def test_in_is_out_below_a_stream(tmp_path, solver):
    """Emitted less drained is present in every step, and what is drained in a while is what was emitted in as long."""
    height, rate = 0.4, 4e-3
    tap = {"shape": DISC, "rotation": DOWN, "position": [0, height, 0], "rate": rate}
    drain = {"shape": {"type": "box", "size": [1, 0.1, 1]}, "position": [0, -0.05, 0]}
    data = scene(solver, tap, fluid={"drains": {"sink": drain}}, probes={"low": {"type": "front", "axis": "-y"}})
    fill, more = 5, 5
    first, last = run(data, tmp_path / "first", fill), run(data, tmp_path / "last", fill + more)
    for out, frame in ((first, fill), (last, fill + more)):
        found = counts(out)
        assert found["particles"] == len(read_frame(out, frame))
        assert found["particles_emitted"] - found["particles_drained"] == found["particles"]
        assert found["particles_blocked"] == found["particles_over_limit"] == 0
    came, went = (counts(last)[name] - counts(first)[name] for name in ("particles_emitted", "particles_drained"))
    assert came == pytest.approx(rate * more / 10 / D**3, abs=LAYER)
    assert went == pytest.approx(came, abs=LAYER)
    present = steps(last)["n_fluid"][steps(last)["time"] > fill / 10]
    assert present.max() - present.min() <= 2 * LAYER
    assert positions(read_frame(last, fill + more))[:, 1].min() > 0


def test_a_drain_takes_what_is_inside(tmp_path):
    """Of a block at rest without gravity, all whose centres are in a ball, from `start` on; nothing else moves, and
    densities are those of what is left, rho = sum_j m W_ij. The squares of the particles' distances from its middle are
    1, 5, 9, ... r^2, so that none is nearer than r / 7 to its surface, at sqrt(51) r."""
    block = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}}
    radius = 51**0.5 * R
    ball = {"shape": {"type": "sphere", "radius": radius}, "position": [0.03, 0, 0.01], "start": 0.15}
    data = {"fps": 10, "gravity": [0, 0, 0], "fluid": {"particle_radius": R, "bodies": {"block": block}}}
    data["fluid"]["drains"] = {"ball": ball}
    out = run(data, tmp_path, 2)
    before, after = read_frame(out, 1), read_frame(out, 2)
    assert len(before) == 1000
    inside = np.linalg.norm(positions(before) - [0.03, 0, 0.01], axis=1) < radius
    assert counts(out)["particles_drained"] == inside.sum() > 100
    assert np.array_equal(after["id"], before["id"][~inside])
    x, h = positions(after), 4 * R
    near = cubic_host(np.linalg.norm(x[:, None] - x, axis=2), h).sum(axis=1)
    np.testing.assert_allclose(after["density"], particle_mass(D, h, 1000) * near, rtol=1e-4)
