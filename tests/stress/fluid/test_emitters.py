"""Emitters against what is in their way, cut into parts, repeated, and at the limit of the number of particles."""

from __future__ import annotations

import itertools
import json
import math
import sys

import numpy as np
import pytest

from scene.settings import Refused
from sim import segment
from sim.spec import CFL, SimulationSpec
from tests.stress.scenes import assert_nothing_broken, contents, failure, finish, make_faults, pool, run_segment
from tests.support.fluid.solvers import LONG, SOLVERS, STRESSED
from tests.support.in_time import in_time
from tests.support.particles import read_frame, read_table

DOWN = [{"axis": [1, 0, 0], "angle": 180}]
SPEED, D = 1.0, 0.04
TAP = {"shape": {"type": "disc", "radius": 0.07}, "position": [0, 0.38, 0], "rotation": DOWN, "speed": SPEED}
LAYER = 9
SINK = {"shape": {"type": "box", "size": [0.1, 0.06, 0.4]}, "position": [0.15, 0.03, 0]}
EVENTS = [
    {"at": 0.047, "set": {"fluid.emitters.tap.speed": 2}},
    {"at": 0.11, "set": {"fluid.emitters.tap.stop": 0.135}},
    {"at": 0.18, "set": {"fluid.emitters.tap.stop": None, "fluid.emitters.tap.position": [-0.05, 0.38, 0.02]}},
    {"at": 0.21, "add": {"emitters": {"side": TAP | {"position": [0.1, 0.3, 0.1], "rotation": [], "speed": 0.4}}}},
    {"at": 0.25, "remove": ["tap"], "add": {"drains": {"late": SINK | {"position": [-0.15, 0.03, 0]}}}},
]
SCENE = pool(fluid__emitters={"tap": TAP}, fluid__drains={"sink": SINK}, events=EVENTS)
"""Within frames, and at those at which the run is cut."""
LAST = 28
CUTS = (11, *in_time(6, 18, 22))
"""While it is stopped; at events; with particles in the nozzle and part of a layer due."""


def counts(out):
    return json.loads((out / "summary.json").read_text())["counts"]


def due(time):
    """Particles that the emitter of SCENE has sent at a time before 0.18 s."""
    way = 1.0 * min(time, 0.047) + 2.0 * max(0.0, min(time, 0.135) - 0.047)
    return LAYER * math.floor(way / D + 1e-9)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "out"
    done = run_segment(SCENE, out, f"0:{LAST}", "--threads", 1)
    assert done.returncode == 0, done.stderr
    return out


def test_the_scene_does_all_of_it(whole):
    found = counts(whole)
    assert found["particles_drained"] > 0 and found["particles_blocked"] == 0
    assert found["particles"] == found["particles_started"] + found["particles_emitted"] - found["particles_drained"]
    table = read_table(whole / "steps.csv")
    ids = [read_frame(whole, frame)["id"] for frame in range(LAST + 1)]
    assert all(len(np.unique(frame)) == len(frame) for frame in ids)
    # No identity is given twice: one that is gone does not come back.
    for now, later in itertools.pairwise(ids):
        assert np.isin(later[later <= now.max()], now).all()
    assert table["n_fluid"].max() > table["n_fluid"][-1] > 0


@pytest.mark.parametrize("frame", [2, 5, 9, 13, 14, 17])
def test_events_are_exact_in_time(tmp_path, simulate, frame):
    """Into nothing, so that all that was due is there."""
    scene = pool(fluid__emitters={"tap": TAP}, fluid__bodies={}, events=EVENTS[:2], gravity=[0, 0, 0])
    assert len(read_frame(simulate(scene, frame, threads=1), frame)) == due(frame / 100)


@pytest.mark.parametrize("cut", CUTS)
def test_a_run_in_parts_is_the_same(whole, tmp_path, cut):
    first, second = tmp_path / "first", tmp_path / "second"
    assert run_segment(SCENE, first, f"0:{cut}", "--threads", 1).returncode == 0
    state = first / f"state_{cut:05d}.npz"
    done = run_segment(SCENE, second, f"{cut + 1}:{LAST}", "--resume", state, "--threads", 1)
    assert done.returncode == 0, done.stderr
    last = f"state_{LAST:05d}.npz"
    assert contents(second, last) == contents(whole, last)
    assert contents(first, "fluid_*.ply") | contents(second, "fluid_*.ply") == contents(whole, "fluid_*.ply")
    assert {name: counts(second)[name] for name in ("particles_emitted", "particles_drained")} == {
        name: counts(whole)[name] for name in ("particles_emitted", "particles_drained")
    }


def test_more_threads_are_the_same(whole, tmp_path):
    assert run_segment(SCENE, tmp_path / "two", f"0:{LAST}", "--threads", 2).returncode == 0
    assert contents(tmp_path / "two", "fluid_*.ply") == contents(whole, "fluid_*.ply")


@pytest.mark.parametrize("solver", STRESSED)
def test_a_frame_that_is_repeated_emits_no_more(simulate, monkeypatch, solver):
    """A fault after 0.05 s takes the frame back, with what has been sent in it."""
    scene = pool(fluid__emitters={"tap": TAP}, fluid__solver=solver, fluid__bodies={}, gravity=[0, 0, 0])
    scene["step"] = {"cfl": 0.2}
    # Kinetic energy [J] of two layers and a bit.
    make_faults(monkeypatch, 2, above=0.5 * 2.5 * LAYER * 1000 * D**3 * SPEED**2)
    out = simulate(scene, 20, threads=1)
    found = counts(out)
    assert found["retries"] == 2 and found["steps_repeated"] > 0
    last = read_frame(out, 20)
    assert found["particles_emitted"] == len(last) == LAYER * math.floor(SPEED * 0.2 / D + 1e-9)
    assert np.array_equal(last["id"], np.arange(len(last)))


@pytest.mark.slow
@pytest.mark.outcome("A")
def test_a_full_box_takes_no_more(simulate, capfd):
    """Its room is 1000 particles; what the outlet cannot send is counted, said once, and the fluid comes to rest."""
    d = 0.02
    data = {
        "fps": 20,
        "containers": {"tank": {"type": "box", "size": [10 * d, 10 * d, 10 * d], "open": []}},
        "fluid": {
            "particle_radius": d / 2,
            "bodies": {"pool": {"shape": {"type": "box", "size": [0.2, 0.14, 0.2]}, "position": [0, 0.07, 0]}},
            "emitters": {"tap": TAP | {"shape": {"type": "disc", "radius": 0.04}, "position": [0, 0.18, 0]}},
        },
    }
    out = simulate(data, 20, threads=1)
    assert_nothing_broken(out)
    found, table = counts(out), read_table(out / "steps.csv")
    layer = 13
    assert found["particles_emitted"] + found["particles_blocked"] == layer * math.floor(1.0 / d + 1e-9)
    assert found["particles_blocked"] > 0 and found["retries"] == 0
    assert 850 < found["particles"] <= 1000
    assert table["density_error_max"].max() < 0.3
    end = table["time"] > 0.9
    assert np.ptp(table["n_fluid"][end]) == 0
    assert table["density_error_max"][end].max() < 0.05
    assert capfd.readouterr().err.count("'tap' is blocked") == 1


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", LONG)
@pytest.mark.parametrize("speed", [1.0, *in_time(5.0)])
def test_an_outlet_in_a_full_box_blows_up_no_solver(tmp_path, solver, speed):
    """Room for 72 particles is filled in 0.32 s, or less; done, or stopped with the last good state."""
    tap = TAP | {"position": [0, 0.22, 0], "speed": speed}
    scene = pool(fluid__emitters={"tap": tap}, fluid__solver=solver, containers__tank__size=[0.24, 0.24, 0.24])
    scene["fluid"]["bodies"] = {
        "pool": {"shape": {"type": "box", "size": [0.24, 0.16, 0.24]}, "position": [0, 0.08, 0]}
    }
    scene["fps"] = 10
    spec, out = SimulationSpec.model_validate(scene), tmp_path / "out"
    status = segment.simulate(spec, tmp_path, out, first=0, last=6, arch="cpu", threads=1, quiet=True)
    assert status in (0, 3)
    if status == 3:
        failure(out)
    assert_nothing_broken(out)
    assert counts(out)["particles_blocked"] > 0
    frames = sorted(out.glob("fluid_*.ply"))
    assert len(read_frame(out, len(frames) - 1)) <= 216
    assert max(read_frame(out, k)["density"].max() for k in range(len(frames))) <= 1300


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", ["dfsph", *in_time("wcsph", "iisph")])
def test_a_stream_is_let_go_where_nothing_gives_way(simulate, solver):
    """A shaft as wide as the stream, with room for four layers and an outlet in its lid: led on to the end of the
    nozzle, the third layer would come half a spacing near to the second, which a run does not survive."""
    scene = pool(fluid__emitters={"tap": TAP | {"position": [0, 4 * D, 0]}}, fluid__solver=solver, fluid__bodies={})
    scene["containers"]["tank"]["size"] = [3 * D, 4 * D, 3 * D]
    out = simulate(scene, 40, threads=1)
    assert_nothing_broken(out)
    assert 2 * LAYER <= counts(out)["particles"] <= 4 * LAYER
    assert read_table(out / "steps.csv")["density_error_max"].max() < 0.3


@pytest.mark.parametrize("solver", STRESSED)
def test_the_step_knows_the_speed_of_emitters(simulate, solver):
    """v dt <= cfl h / 2 from the first step, before there is any particle; a fixed step beyond is refused."""
    scene = pool(fluid__emitters={"tap": TAP | {"speed": 4}}, fluid__solver=solver, fluid__bodies={})
    steps = read_table(simulate(scene, 2, threads=1) / "steps.csv")
    assert (4 * steps["dt"]).max() <= CFL.get(solver, 0.4) * 0.04 * (1 + 1e-9)
    with pytest.raises(Refused, match=r"beyond the stability limit"):
        simulate(scene | {"step": {"fixed": 0.1}}, 2, threads=1)


@pytest.mark.outcome("B")
@pytest.mark.parametrize("solver", STRESSED)
def test_a_speed_beyond_all_bounds_is_refused(simulate, solver):
    scene = pool(fluid__emitters={"tap": TAP | {"speed": 1e6}}, fluid__solver=solver)
    with pytest.raises(Refused, match=r"emitters 1e\+06 m/s.* allows steps of"):
        simulate(scene, 2, threads=1)


def test_what_is_in_a_nozzle_that_moves_goes_straight_on(simulate):
    """Without gravity: an emitter that is moved and turned, or removed, lets go of what it leads, as it is."""
    tap = TAP | {"position": [0, 0.2, 0], "rotation": []}
    moved = {"fluid.emitters.tap.position": [0.05, 0.1, 0], "fluid.emitters.tap.rotation": DOWN}
    events = [{"at": 0.065, "set": moved}, {"at": 0.125, "remove": ["tap"]}]
    scene = pool(fluid__emitters={"tap": tap}, fluid__bodies={}, events=events, gravity=[0, 0, 0])
    scene["containers"]["tank"] |= {"position": [0, -0.2, 0], "size": [0.4, 0.8, 0.4]}
    last = read_frame(simulate(scene, 16, threads=1), 16)
    # 1.625 layers, then up to 3.125.
    assert len(last) == 3 * LAYER
    direction = np.where(last["id"] < LAYER, 1.0, -1.0)
    np.testing.assert_allclose(last["vy"], direction * SPEED, rtol=0.01)
    sent = np.where(last["id"] < LAYER, D, np.where(last["id"] < 2 * LAYER, 2 * D, 3 * D)) / SPEED
    start = np.where(last["id"] < LAYER, 0.2, 0.1)
    np.testing.assert_allclose(last["y"], start + direction * (D / 2 + SPEED * (0.16 - sent)), atol=0.01 * D)


def test_a_run_goes_on_with_an_emitter_elsewhere(simulate):
    """A state may go on with other settings: what is in a nozzle that is not there any more is free."""
    tap = TAP | {"position": [0, 0.2, 0], "rotation": []}
    scene = pool(fluid__emitters={"tap": tap}, fluid__bodies={}, gravity=[0, 0, 0])
    first = simulate(scene, 6, "first", threads=1)
    scene["fluid"]["emitters"] = {"tap": tap | {"position": [0, 0.1, 0], "rotation": DOWN}}
    out = simulate(scene, 9, "second", first=7, state=first / "state_00006.npz", threads=1)
    last = read_frame(out, 9)
    np.testing.assert_allclose(last["vy"], np.where(last["id"] < LAYER, 1.0, -1.0) * SPEED, rtol=0.01)


@pytest.mark.outcome("A")
def test_emitters_pause_at_the_limit(simulate, capfd):
    """While there are 50 particles nothing comes; a drain makes room, and layers come again."""
    scene = pool(fluid__emitters={"tap": TAP}, fluid__bodies={}, fluid__max_particles=50)
    scene["fluid"]["drains"] = {"floor": {"shape": {"type": "box", "size": [0.4, 0.1, 0.4]}, "start": 0.3}}
    out = simulate(scene, 40, threads=1)
    found = counts(out)
    present = [len(read_frame(out, frame)) for frame in range(41)]
    assert max(present) == LAYER * (50 // LAYER)
    assert found["particles_emitted"] + found["particles_over_limit"] == LAYER * math.floor(0.4 / D + 1e-9)
    assert found["particles_over_limit"] > 0 and found["particles_blocked"] == 0
    assert found["particles_emitted"] > max(present)
    assert found["particles_drained"] == found["particles_emitted"] - present[-1] > 0
    assert capfd.readouterr().err.count("fluid.max_particles = 50 is reached") == 1


@pytest.mark.outcome("A")
def test_all_fluid_may_be_drained_and_come_again(simulate):
    """A step may begin or end without any particle, for every number of them."""
    whole = {"shape": {"type": "box", "size": [1, 1, 1]}, "start": 0.05, "stop": 0.1}
    for solver in SOLVERS:
        scene = pool(fluid__emitters={"tap": TAP}, fluid__drains={"all": whole}, fluid__solver=solver)
        out = simulate(scene, 20, solver, threads=1)
        present = [len(read_frame(out, frame)) for frame in range(21)]
        assert present[4] > LAYER and present[20] > LAYER
        # What has come in the last step is drained in the next.
        assert max(present[6:10]) <= LAYER and min(present[6:10]) == 0
        assert counts(out)["steps_capped"] == 0
        assert_nothing_broken(out)


def test_a_scene_without_them_knows_nothing_of_them(tmp_path):
    """Neither modules nor kernels."""
    code = (
        "import json, sys; from sim.segment import main; "
        "status = main(json.loads(sys.argv[1])); "
        "print([name for name in sys.modules if name.split('.')[0] == 'sim' and name.split('.')[-1] in "
        "('flow', 'streams', 'drains', 'emitters', 'outlets')]); sys.exit(status)"
    )
    arguments = ["--spec", json.dumps(pool()), "--folder", ".", "--frames", "0:1", "--out", "out", "--arch", "cpu"]
    done = finish([sys.executable, "-c", code, json.dumps(arguments)], tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[]"
