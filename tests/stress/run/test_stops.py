"""The failure policy: refused before the first step, or stopped with the last good state and a full report."""

from __future__ import annotations

import json

import numpy as np
import pytest

from scene.settings import Refused
from tests.stress.scenes import assert_nothing_broken, failure, make_faults, pool, run_segment
from tests.support.particles import positions, read_frame, read_table, velocities

G = 9.81
CONTRACT = {"detected", "step", "time", "retries", "particles", "last_good_frame", "last_good_state", "change"}
FASTER = pool(gravity=[0, 0, 0], step={"fixed": 4e-3}, events=[{"at": 0.035, "set": {"gravity": [0, -2000, 0]}}])
"""A fixed step that is right until gravity, and the speed of sound with it, rises in frame 4."""
TOO_FAST = pool(fluid__wcsph={"speed_of_sound": 0.5})
"""Falls faster than its sound after 51 ms: no step is short enough."""
IN_FRAME_2 = 0.1
"""Kinetic energy [J] of 8 kg that have fallen for 16 ms."""


def summary(out):
    return json.loads((out / "summary.json").read_text())


def assert_stopped(out):
    """What every stopped run leaves behind; returns the last good frame."""
    report = failure(out)
    assert set(report) == CONTRACT
    frame = report["last_good_frame"]
    assert sorted(path.name for path in out.glob("fluid_*.ply")) == [f"fluid_{k:05d}.ply" for k in range(frame + 1)]
    assert [path.name for path in out.glob("state_*.npz")] == [report["last_good_state"]]
    time = frame / 100
    assert report["time"] > time
    assert np.atleast_1d(read_table(out / "steps.csv"))["time"].max() == pytest.approx(time, rel=1e-8)
    assert summary(out)["status"] == "stopped"
    assert summary(out)["simulated_s"] == pytest.approx(time)
    assert_nothing_broken(out)
    return frame


@pytest.mark.outcome("B")
def test_a_step_far_beyond_the_limit_is_refused(tmp_path):
    done = run_segment(pool(step={"fixed": 0.1}), tmp_path / "out", "0:4")
    assert done.returncode == 2
    assert "step.fixed" in done.stderr
    assert "stability limit" in done.stderr
    assert not list((tmp_path / "out").iterdir())


@pytest.mark.outcome("C")
def test_a_step_that_becomes_too_long_stops_the_run(tmp_path):
    done = run_segment(FASTER, tmp_path / "out", "0:8")
    assert done.returncode == 3, done.stderr
    assert_stopped(tmp_path / "out")
    report = failure(tmp_path / "out")
    assert report["last_good_frame"] == 3
    assert "0.004 s is beyond the stability limit" in report["detected"]
    for text in (report["detected"], report["change"], report["last_good_state"]):
        assert text in done.stderr


@pytest.fixture(scope="module")
def too_fast(tmp_path_factory):
    out = tmp_path_factory.mktemp("too_fast") / "out"
    done = run_segment(TOO_FAST, out, "0:8")
    assert done.returncode == 3, done.stderr
    return out


@pytest.mark.outcome("C")
def test_a_stopped_run_leaves_all_that_was_good(too_fast):
    # v = g t passes 0.5 m/s after 51 ms.
    assert assert_stopped(too_fast) == 5
    assert summary(too_fast)["counts"]["retries"] == failure(too_fast)["retries"] == 4


def test_the_report_names_particles(too_fast):
    report = failure(too_fast)
    assert "faster than sound (0.5 m/s)" in report["detected"]
    assert "speed_of_sound" in report["change"]
    assert report["time"] == pytest.approx(0.5 / G, abs=0.01)
    last = read_frame(too_fast, 5)
    assert report["particles"]
    for particle in report["particles"]:
        before = positions(last[last["id"] == particle["id"]])[0]
        assert np.linalg.norm(np.array(particle["position"]) - before) < 0.01 * 0.6
        assert particle["speed"] > 0.4


def test_the_last_good_state_goes_on_with_another_setting(too_fast, simulate):
    scene = pool(fluid__wcsph={"speed_of_sound": 20})
    out = simulate(scene, 8, first=6, state=too_fast / failure(too_fast)["last_good_state"])
    assert len(read_frame(out, 8)) == len(read_frame(too_fast, 5))
    assert_nothing_broken(out)


@pytest.mark.outcome("A")
@pytest.mark.parametrize("faults", [1, 4])
def test_a_frame_after_retries_is_right(simulate, monkeypatch, capfd, faults):
    """Fluid in free fall, y = y0 - g t^2 / 2 for any step; the retries show in the summary and in the log."""
    make_faults(monkeypatch, faults, above=IN_FRAME_2)
    out = simulate(pool(), 4)
    counts = summary(out)["counts"]
    steps = read_table(out / "steps.csv")
    assert counts["retries"] == faults
    # Each try makes a step of half the length, and twice as many before the fault.
    assert counts["steps_repeated"] >= 2 ** (faults - 1)
    assert counts["steps"] == len(steps)
    assert np.all(np.diff(steps["step"]) == 1)
    np.testing.assert_allclose(np.cumsum(steps["dt"]), steps["time"], rtol=1e-6)
    log = capfd.readouterr().err
    assert log.count("frame 2: a fault of the test; again with") == faults
    assert f"again with {0.5**faults:g} of the step" in log
    first, last = read_frame(out, 0), read_frame(out, 4)
    fallen = G * 0.04**2 / 2
    # The block holds together but for the damping and ringing of its lattice.
    np.testing.assert_allclose((positions(first) - positions(last)).mean(axis=0), [0, fallen, 0], atol=0.01 * fallen)
    np.testing.assert_allclose(velocities(last).mean(axis=0), [0, -G * 0.04, 0], atol=0.01 * G * 0.04)
    frame_2 = steps["dt"][(steps["time"] > 0.0101) & (steps["time"] < 0.0201)]
    frame_1 = steps["dt"][steps["time"] < 0.0101]
    assert frame_2.max() < 1.2 * 0.5**faults * frame_1.max()


@pytest.mark.outcome("C")
def test_five_faults_stop_the_run(simulate, monkeypatch):
    make_faults(monkeypatch, 5, above=IN_FRAME_2)
    out = simulate(pool(), 4, expect=3)
    assert assert_stopped(out) == 1
    assert failure(out)["retries"] == 4
    assert failure(out)["detected"] == "a fault of the test"


@pytest.mark.outcome("A")
def test_shortened_steps_recover(simulate, monkeypatch):
    make_faults(monkeypatch, 2, above=IN_FRAME_2)
    out = simulate(pool(gravity=[0, -G, 0]), 5)
    steps = read_table(out / "steps.csv")
    frame = np.ceil(steps["time"] * 100 - 1e-6)
    longest = [steps["dt"][frame == k].max() for k in range(1, 6)]
    assert longest[1] < longest[3] <= longest[4]


@pytest.mark.outcome("C")
def test_what_is_not_finite_stops_the_run(simulate, monkeypatch):
    """Whatever makes a value that is no number, it is seen after the step."""
    from sim.fluid.pressure.wcsph import Wcsph

    advance = Wcsph.advance

    def poisoned(self, dt):
        told = advance(self, dt)
        velocity = self.system.particles.velocity.to_numpy()
        velocity[7, 1] = np.nan
        self.system.particles.velocity.from_numpy(velocity)
        return told

    monkeypatch.setattr(Wcsph, "advance", poisoned)
    out = simulate(pool(), 2, expect=3)
    report = failure(out)
    assert "not finite" in report["detected"]
    assert report["particles"][0]["speed"] == "nan"
    assert assert_stopped_at_start(out)


def assert_stopped_at_start(out):
    assert_nothing_broken(out)
    return [path.name for path in sorted(out.glob("*0*"))] == ["fluid_00000.ply", "state_00000.npz"]


@pytest.mark.outcome("C")
def test_an_event_without_room_stops_the_run(simulate):
    """Known only when it happens, with steps done: stopped, not refused."""
    same = {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "position": [0, 0.15, 0]}
    out = simulate(pool(events=[{"at": 0.025, "add": {"fluid": {"more": same}}}]), 4, expect=3)
    assert assert_stopped(out) == 2
    assert "no particle of 'more'" in failure(out)["detected"]


def test_a_run_that_succeeds_leaves_no_old_failure(simulate):
    simulate(FASTER, 8, expect=3)
    out = simulate(pool(), 2)
    assert not (out / "failure.json").exists()
    assert summary(out)["status"] == "done"


@pytest.mark.outcome("B")
def test_a_bad_number_of_threads_is_refused(simulate):
    with pytest.raises(Refused, match="threads"):
        simulate(pool(), 1, threads=0)
