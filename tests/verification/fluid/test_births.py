"""When particles came, and from where: ages of what flies freely are ways over speeds, whatever the steps were."""

from __future__ import annotations

import numpy as np
import pytest

from common.simulation_files import read_sources
from scene.settings import Refused
from sim.run.checkpoint import Checkpoint
from sim.spec import SimulationSpec
from tests.stress.scenes import make_faults
from tests.support.fluid.solvers import SOLVERS, run
from tests.support.particles import positions, read_frame, velocities
from workflow.stages.surface.known import Known
from workflow.stages.surface.spec import ReconstructSpec

R = 0.01
D = 2 * R
FPS = 10
DISC = {"type": "disc", "radius": 2.2 * D}
LAYER = 16
"""Particles of one."""
BLOCK = {"type": "box", "size": [4 * D] * 3}
CLOSE = 1e-6
"""Of ages [s], by positions in single precision at 1 m/s."""


def scene(emitters, *, bodies=None, **others):
    """Without gravity: what comes out of a nozzle along y at x = z = 0, 1 m, ... stays at its speed."""
    fluid = {"particle_radius": R, "emitters": emitters, "bodies": bodies or {}, **others.pop("fluid", {})}
    return {"fps": FPS, "gravity": [0, 0, 0], "fluid": fluid, **others}


def tap(speed, x=0.0, **others):
    return {"shape": DISC, "position": [x, 0, 0], "speed": speed, **others}


def ages(out, frame, points, *, fps=FPS):
    """As the surface is told them [s]."""
    spec = {"particle_radius": R, "fps": fps, "surface": {"attributes": ["age"]}}
    return Known.of(ReconstructSpec.model_validate(spec), out).columns(points, frame)["age"]


def came_from(out, points):
    """The name of the source of each particle."""
    found = read_sources(out)
    return np.array([found.names[found.index[row]] for row in found.rows(points["id"].tolist())])


def flown(points):
    """For how long it has moved from the outlet, half a spacing behind its centre, at its speed [s]."""
    return (positions(points)[:, 1] - D / 2) / velocities(points)[:, 1]


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_age_is_the_way_over_the_speed(tmp_path, solver):
    """From `start` on, with layers that leave within steps; positions may be wrong by 1 % of the spacing."""
    data = scene({"tap": tap(0.73, start=0.0317)}, fluid={"solver": solver})
    out = run(data, tmp_path, 3)
    for frame in (1, 2, 3):
        points = read_frame(out, frame)
        found = ages(out, frame, points)
        assert found == pytest.approx(flown(points), abs=0.01 * D / 0.73)
        assert found == pytest.approx(frame / FPS - (0.0317 + (1 + points["id"] // LAYER) * D / 0.73), abs=1e-9)


@pytest.mark.parametrize("step", [{}, {"cfl": 0.1}, {"fixed": 1.7e-3}])
def test_steps_do_not_matter(tmp_path, step):
    data = scene({"tap": tap(1.0)}, step=step)
    rows = read_sources(run(data, tmp_path, 2))
    assert rows.time == pytest.approx(D * np.arange(1, len(rows.time) + 1), abs=1e-9)


def test_of_several_bodies_and_emitters_each_has_its_own(tmp_path):
    """An event brings a body within a frame, another doubles the speed of an emitter, which leaves its stream whole."""
    bodies = {"near": {"shape": BLOCK, "position": [-1, 0, 0]}, "far": {"shape": BLOCK, "position": [-2, 0, 0]}}
    late = {"shape": BLOCK, "position": [-3, 0, 0]}
    events = [
        {"at": 0.123, "add": {"fluid": {"late": late}}},
        {"at": 0.123, "add": {"emitters": {"third": tap(0.6, 2.0, start=0.15)}}},
        {"at": 0.161, "set": {"fluid.emitters.second.speed": 1.0}},
        {"at": 0.17, "remove": ["first"]},
    ]
    data = scene({"first": tap(0.9), "second": tap(0.5, 1.0)}, bodies=bodies, events=events)
    out = run(data, tmp_path, 3)
    points = read_frame(out, 3)
    names, found = came_from(out, points), ages(out, 3, points)
    place = np.round(positions(points)[:, 0]).astype(int)
    for name, x in {"near": -1, "far": -2, "late": -3, "first": 0, "second": 1, "third": 2}.items():
        assert np.array_equal(names == name, place == x), name
    assert found[np.isin(names, ["near", "far"])] == pytest.approx(0.3)
    assert found[names == "late"] == pytest.approx(0.3 - 0.123)
    steady = np.isin(names, ["first", "third"])
    assert found[steady] == pytest.approx(flown(points[steady]), abs=0.01 * D)
    # Before 0.161 s the second has sent 0.0805 m: four layers, the fifth leaves when 0.0195 m more have come at 1 m/s.
    sent = np.unique(np.round(0.3 - found[names == "second"], 9))
    assert sent == pytest.approx([0.04, 0.08, 0.12, 0.16, *(0.1805 + D * np.arange(6))], abs=1e-9)


def test_a_drain_takes_particles_and_no_ages(tmp_path):
    drain = {"shape": {"type": "box", "size": [1, 0.1, 1]}, "position": [0, 0.15, 0]}
    still = {"shape": BLOCK, "position": [1, 0, 0]}
    data = scene({"tap": tap(1.0)}, fluid={"drains": {"sink": drain}}, bodies={"still": still})
    out = run(data, tmp_path, 4)
    points = read_frame(out, 4)
    moving = came_from(out, points) == "tap"
    assert points["id"][moving].min() > 64 and 0 < moving.sum() < 16 * 6
    assert ages(out, 4, points)[moving] == pytest.approx(flown(points[moving]), abs=CLOSE)
    assert ages(out, 4, points)[~moving] == pytest.approx(0.4)


TWO = scene({"a": tap(0.9), "b": tap(0.7, 1.0)}, bodies={"still": {"shape": BLOCK, "position": [-1, 0, 0]}})
"""A scene of several births in each frame."""


def test_a_run_that_goes_on_tells_the_same(tmp_path):
    """Each part has the births of those before it: the same bytes as in one run, in sources.csv and in the state."""
    from sim.segment import simulate

    whole, first = run(TWO, tmp_path / "whole", 4), run(TWO, tmp_path / "first", 2)
    spec, second = SimulationSpec.model_validate(TWO), tmp_path / "second"
    options = {"arch": "cpu", "threads": 1, "quiet": True, "state": first / "state_00002.npz"}
    assert simulate(spec, second, second, first=3, last=4, **options) == 0
    for name in ("sources.csv", "state_00004.npz"):
        assert (second / name).read_bytes() == (whole / name).read_bytes()
    rows, early = read_sources(second), read_sources(first)
    assert early.names == rows.names == ("still", "a", "b")
    assert rows.first[: len(early.first)] == early.first and len(rows.first) > len(early.first)


def test_a_frame_that_is_repeated_brings_nothing_twice(tmp_path, monkeypatch):
    whole = run(TWO, tmp_path / "whole", 2)
    make_faults(monkeypatch, 1, above=0.0)
    assert read_sources(run(TWO, tmp_path / "again", 2)) == read_sources(whole)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("first", lambda values: values[::-1]),
        ("first", lambda values: values[1:]),
        ("first", lambda values: values + 1),
        ("source", lambda values: values + 3),
        ("time", lambda values: values - 1),
    ],
)
def test_births_that_cannot_be_are_refused(tmp_path, name, change):
    state = run(TWO, tmp_path, 1) / "state_00001.npz"
    with np.load(state) as stored:
        arrays = dict(stored)
    arrays[f"births.{name}"] = change(arrays[f"births.{name}"])
    np.savez(state, **arrays)
    with pytest.raises(Refused, match="is not a state"):
        Checkpoint.load(state, SimulationSpec.model_validate(TWO))
