"""A run in two parts equals the run in one, byte for byte; what is no state of it is refused."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

from scene.settings import Refused
from tests.stress.scenes import contents, finish, make_faults, pool, run_segment
from tests.support.particles import read_frame, read_table

DROP = {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "position": [0.1, 0.3, 0.1], "velocity": [0, -1, 0]}
EVENTS = [
    {"at": 0.025, "add": {"fluid": {"drop": DROP}}},
    {"at": 0.04, "set": {"gravity": [3, -9, 0]}},
    {"at": 0.04, "add": {"fluid": {"late": DROP | {"position": [-0.1, 0.3, -0.1]}}}},
    {"at": 0.065, "remove": ["drop"]},
]
"""Within a frame, and at the time of the frame at which the run is cut."""
IN_FRAME_4 = 0.5
"""Kinetic energy [J] of 8 kg that have fallen for 36 ms."""
SCENE = pool(events=EVENTS, probes={"height": {"type": "water_height", "x": 0, "rate": 300}})


def assert_continued(whole, first, second):
    """The frames, the last state and the tables of two parts are those of the whole."""
    for pattern in ("fluid_*.ply", "state_00008.npz"):
        parts = (contents(first, pattern) if "fluid" in pattern else {}) | contents(second, pattern)
        assert parts == contents(whole, pattern)
    assert (second / "sources.csv").read_bytes() == (whole / "sources.csv").read_bytes()
    for table in set(whole.glob("*s.csv")) - {whole / "sources.csv"}:
        rows = [read_table(folder / table.name) for folder in (whole, first, second)]
        names = [name for name in rows[0].dtype.names if name != "wall_s"]
        np.testing.assert_array_equal(np.concatenate(rows[1:])[names], rows[0][names])


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """The whole run, and the first part."""
    folder = tmp_path_factory.mktemp("parts")
    for name, frames in (("whole", "0:8"), ("first", "0:4")):
        done = run_segment(SCENE, folder / name, frames)
        assert done.returncode == 0, done.stderr
    return folder


def test_a_segment_goes_on_across_events(parts):
    done = run_segment(SCENE, parts / "second", "5:8", "--resume", parts / "first" / "state_00004.npz")
    assert done.returncode == 0, done.stderr
    counts = [len(read_frame(parts / "whole", frame)) for frame in (2, 3, 4, 5, 6, 7)]
    assert counts[0] < counts[1] == counts[2] < counts[3] == counts[4] > counts[5]
    assert_continued(parts / "whole", parts / "first", parts / "second")


def test_the_scene_command_goes_on_in_the_same_folder(parts, tmp_path):
    """What the first part has left in the tables stays."""
    (tmp_path / "pool.yaml").write_text(json.dumps({"duration": 0.08, "quality": "draft"} | SCENE))
    run = [sys.executable, "-m", "sim", "run", "pool.yaml", "--out", "out", "--arch", "cpu"]
    assert finish([*run, "--frames", "0:4"], tmp_path).returncode == 0
    done = finish([*run, "--resume", "out/state_00004.npz"], tmp_path)
    assert done.returncode == 0, done.stderr
    out, whole = tmp_path / "out", parts / "whole"
    assert contents(out, "fluid_*.ply") == contents(whole, "fluid_*.ply")
    assert contents(out, "state_00008.npz") == contents(whole, "state_00008.npz")
    assert (out / "probes.csv").read_bytes() == (whole / "probes.csv").read_bytes()
    assert len(read_table(out / "steps.csv")) == len(read_table(whole / "steps.csv"))


def test_jacobi_iterations_of_dfsph_go_on(simulate):
    """Beside a body that is moved: velocities that the step made free of divergence are what the next one begins
    with."""
    paddle = {"shape": {"type": "box", "size": [0.04, 0.2, 0.3]}, "position": [0.15, 0.1, 0]}
    paddle |= {"motion": "prescribed", "velocity": [-0.5, 0, 0]}
    settings = {"fluid__solver": "dfsph", "fluid__dfsph": {"iteration": "jacobi"}, "rigid": {"bodies": {"p": paddle}}}
    scene = pool(probes={"push": {"type": "force", "body": "p", "rate": 300}}, **settings)
    whole, first = simulate(scene, 8, "whole"), simulate(scene, 4, "first")
    second = simulate(scene, 8, "second", first=5, state=first / "state_00004.npz")
    assert_continued(whole, first, second)


def test_a_run_that_recovers_goes_on(simulate, tmp_path, monkeypatch):
    """The state keeps that steps are shorter for a while."""

    scene = pool()
    make_faults(monkeypatch, 1, above=IN_FRAME_4)
    whole = simulate(scene, 8, "whole")
    make_faults(monkeypatch, 1, above=IN_FRAME_4)
    first = simulate(scene, 4, "first")
    monkeypatch.undo()
    with np.load(first / "state_00004.npz") as state:
        meta = json.loads(str(state["meta"]))
    assert meta["clock"]["step_scale"] < 1
    assert meta["counts"]["retries"] == 1
    second = simulate(scene, 8, "second", first=5, state=first / "state_00004.npz")
    assert_continued(whole, first, second)


def cut(path):
    path.write_bytes(path.read_bytes()[:-200])


def flip(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)


def edit(name, change):
    def damage(path):
        with np.load(path) as state:
            arrays = dict(state)
        arrays[name] = change(arrays[name])
        np.savez(path, **arrays)

    return damage


def poison(values):
    values[3, 0] = np.nan
    return values


def array(path):
    with path.open("wb") as stream:
        np.save(stream, np.zeros(3))


DAMAGE = {
    "cut": cut,
    "flipped": flip,
    "text": lambda path: path.write_text("frame 4\n"),
    "empty": lambda path: path.write_bytes(b""),
    "array": array,
    "missing": lambda path: path.unlink(),
    "nan": edit("fluid.velocity", poison),
    "short": edit("fluid.tag", lambda values: values[1:]),
    "kind": edit("fluid.position", lambda values: values.astype(np.float64)),
    "births": edit("births.time", lambda values: values[1:]),
    "meta": edit("meta", lambda _: np.array("[]")),
}


@pytest.mark.outcome("B")
@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_states_are_refused(parts, tmp_path, simulate, damage):
    state = tmp_path / "state_00004.npz"
    state.write_bytes((parts / "first" / "state_00004.npz").read_bytes())
    DAMAGE[damage](state)
    with pytest.raises(Refused, match=r"state_00004.npz.* state"):
        simulate(SCENE, 8, first=5, state=state)
    assert not (tmp_path / "run").exists()


@pytest.mark.outcome("B")
@pytest.mark.parametrize(
    ("changes", "first", "message"),
    [
        ({"fluid__particle_radius": 0.03}, 5, "particle_radius"),
        ({"fluid__support_ratio": 3}, 5, "support_ratio"),
        ({"fps": 50}, 5, "fps"),
        ({}, 6, "the state after frame 4, and frame 6 was to come next"),
        ({}, 1, "the state after frame 4, and frame 1 was to come next"),
    ],
)
def test_states_of_something_else_are_refused(parts, simulate, changes, first, message):
    with pytest.raises(Refused, match=message):
        simulate(pool(**changes), 8, first=first, state=parts / "first" / "state_00004.npz")


@pytest.mark.parametrize(
    "change", [{"gravity": [0, -1, 0]}, {"fluid__viscosity": 0.01}, {"step": {"cfl": 0.2}}, {"events": []}]
)
def test_other_settings_may_go_on(parts, simulate, change):
    out = simulate(pool(**change), 5, first=5, state=parts / "first" / "state_00004.npz")
    assert len(read_frame(out, 5)) == len(read_frame(parts / "first", 4))


@pytest.mark.outcome("B")
def test_the_commands_refuse_with_two(parts, tmp_path):
    (tmp_path / "pool.yaml").write_text(json.dumps({"duration": 0.08, "quality": "draft"} | SCENE))
    state = tmp_path / "state.npz"
    state.write_text("no state")
    run = [sys.executable, "-m", "sim", "run", "pool.yaml", "--out", "out", "--resume", "state.npz"]
    for done in (finish(run, tmp_path), run_segment(SCENE, tmp_path / "out", "5:8", "--resume", state)):
        assert done.returncode == 2
        assert "is not a state of a run" in done.stderr
        assert "Traceback" not in done.stderr


@pytest.mark.outcome("B")
@pytest.mark.parametrize("spec", ["{", "[]", '{"fps": 0}', '{"fps": 24, "unknown": 1}', "@nowhere.json"])
def test_settings_that_are_none_are_refused(tmp_path, spec):
    from sim.segment import main

    assert main(["--spec", spec, "--folder", str(tmp_path), "--frames", "0:1", "--out", str(tmp_path / "out")]) == 2
