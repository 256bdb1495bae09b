"""A run with bodies that move, in two parts or with repeated steps, equals the run in one, byte for byte."""

from __future__ import annotations

import pytest

from tests.stress.run.test_resume import IN_FRAME_4, assert_continued
from tests.stress.scenes import contents, make_faults, pool, run_segment
from tests.support.fluid.solvers import STRESSED

KEYS = [
    {"at": 0.0123, "position": [0, 0.02, 0]},
    {"at": 0.0437, "position": [0.03, 0.05, 0], "rotation": [{"axis": [0, 0, 1], "angle": 25}]},
    {"at": 0.0777, "position": [0.0, 0.02, 0.02]},
]
PADDLE = {"shape": {"type": "box", "size": [0.3, 0.06, 0.3]}, "motion": "prescribed", "keyframes": KEYS}
SPINNER = {
    "shape": {"type": "sphere", "radius": 0.05},
    "position": [0.1, 0.3, 0.1],
    "motion": "prescribed",
    "velocity": [-0.5, 0, -0.5],
    "angular_velocity": [0, 5, 0],
}
DROP = {"shape": {"type": "box", "size": [0.2, 0.1, 0.2]}, "position": [0, 0.32, 0], "velocity": [0, -1, 0]}
EVENTS = [
    {"at": 0.025, "add": {"rigid": {"spinner": SPINNER}}},
    {"at": 0.04, "add": {"fluid": {"drop": DROP}}},
]


def scene(solver):
    """125 particles on a paddle that lifts them; a ball comes and flies through, and more fluid around it."""
    return pool(
        fluid__solver=solver,
        fluid__bodies__water__position=[0, 0.17, 0],
        rigid__bodies={"paddle": PADDLE},
        probes={"push": {"type": "force", "body": "paddle", "rate": 300}},
        events=EVENTS,
    )


@pytest.mark.parametrize("solver", STRESSED)
@pytest.mark.parametrize("cut", [2, pytest.param(4, marks=pytest.mark.slow)])
def test_two_parts_are_the_whole(simulate, solver, cut):
    whole = simulate(scene(solver), 8, "whole", threads=1)
    first = simulate(scene(solver), cut, "first", threads=1)
    state = first / f"state_{cut:05d}.npz"
    second = simulate(scene(solver), 8, "second", first=cut + 1, state=state, threads=1)
    assert_continued(whole, first, second)


def test_a_repeated_frame_is_as_if_it_were_the_first_try(simulate, monkeypatch):
    """A fault in a frame sets all back, bodies too: two faults give what a step of a quarter gives at once."""
    outs = []
    for name in ("one", "two"):
        make_faults(monkeypatch, 2, above=IN_FRAME_4 / 5)
        outs.append(simulate(scene("wcsph"), 6, name, threads=1))
        monkeypatch.undo()
    assert contents(outs[0], "fluid_*.ply") == contents(outs[1], "fluid_*.ply")
    assert contents(outs[0], "bodies.csv") == contents(outs[1], "bodies.csv")
    first = contents(simulate(scene("wcsph"), 6, "plain", threads=1), "bodies.csv")
    assert first == contents(outs[0], "bodies.csv")


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["dfsph", "wcsph"])
def test_threads_do_not_matter(tmp_path, solver):
    outs = []
    for threads in (1, 2):
        outs.append(tmp_path / str(threads))
        done = run_segment(scene(solver), outs[-1], "0:4", "--threads", threads)
        assert done.returncode == 0, done.stderr
    for pattern in ("fluid_*.ply", "state_*.npz", "bodies.csv"):
        assert contents(outs[0], pattern) == contents(outs[1], pattern)


@pytest.mark.slow
def test_two_parts_of_a_box_on_cloth_beside_a_paddle_are_the_whole(simulate):
    """A paddle that is led to where it is goes on from there: it was struck as if it came from where it was placed."""
    data = {
        "fps": 20,
        "rigid": {
            "bodies": {
                "floor": {"shape": {"type": "plane"}},
                "low": {"shape": {"type": "box", "size": [0.2, 0.05, 0.2]}, "motion": "dynamic", "density": 400}
                | {"position": [0, 0.025, 0]},
                "box": {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "motion": "dynamic", "density": 400}
                | {"position": [0, 0.14, 0.02], "angular_velocity": [1, 2, 0]},
                "paddle": {"shape": {"type": "box", "size": [0.02, 0.2, 0.1]}, "motion": "prescribed"}
                | {"position": [0.165, 0.12, 0], "angular_velocity": [0, 6, 0]},
            }
        },
        "cloth": {
            "sheets": {
                "rag": {"shape": {"type": "sheet", "size": [0.2, 0.2]}, "spacing": 0.05, "thickness": 0.005}
                | {"position": [0, 0.07, 0], "mass_per_area": 0.5}
            }
        },
    }
    whole = simulate(data, 6, "whole", threads=1)
    first = simulate(data, 4, "first", threads=1)
    second = simulate(data, 6, "second", first=5, state=first / "state_00004.npz", threads=1)
    for name in ("cloth_rag_00005.ply", "cloth_rag_00006.ply"):
        assert (whole / name).read_bytes() == (second / name).read_bytes()
    assert (whole / "state_00006.npz").read_bytes() == (second / "state_00006.npz").read_bytes()
