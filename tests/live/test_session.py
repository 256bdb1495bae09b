"""What is done to a live run is in the saved scene, which gives the same bytes."""

from __future__ import annotations

import time
from contextlib import closing

import numpy as np
import pytest

from scene.document import SceneError
from scene.load import load
from sim.run.failure import Fault
from tests.live.stage import COARSE, SCENE, Stage, bytes_in

BOX = {"shape": {"type": "box", "size": [0.08, 0.08, 0.08]}, "density": 300, "motion": "dynamic"}


@pytest.fixture
def stage(tmp_path):
    stage = Stage(tmp_path)
    yield stage
    stage.close()


def test_a_body_that_is_added_floats(tmp_path):
    """With half the density of water its middle is at the surface, to a particle's size, when it no longer bobs."""
    with closing(Stage(tmp_path, COARSE)) as stage:
        session = stage.session
        added = BOX | {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "density": 500, "position": [0.1, 0.5, 0.1]}
        stage.change(add={"rigid": {"added": added}})
        session.play()
        stage.until(lambda session: session.clock.frame >= 44, 300)
        session.pause()
        stage.until(lambda session: session.status.mode == "paused")
        states = [kept.rigid for kept in session.history.kept if kept.clock.frame >= 34]
        heights = [state.position[state.names.index("added"), 1] for state in states]
        assert np.mean(heights) == pytest.approx(0.3, abs=0.04)


def test_a_saved_scene_gives_the_same_bytes(stage, simulate, tmp_path):
    """Changes at rest, while it plays, and after it went back."""
    session = stage.session
    stage.change(set={"gravity": [0.0, -5.0, 0.0]})
    stage.change(add={"rigid": {"first": BOX | {"position": [0.1, 0.5, 0.1]}}})
    session.play()
    stage.until(lambda session: session.status.frame >= 3)
    stage.change(add={"rigid": {"second": BOX | {"position": [-0.1, 0.6, 0.1]}}})
    stage.until(lambda session: session.status.frame >= 5)
    stage.change(set={"fluid.viscosity": 1e-3})
    stage.until(lambda session: session.status.frame >= 7)
    session.go_back(6)
    stage.until(lambda session: session.status.frame == 6 and session.status.mode == "paused")
    stage.change(remove=["first"])
    stage.step()
    stage.step()
    saved = []
    session.save(tmp_path / "scenes" / "played.yaml", saved.append, stage.problems.append)
    stage.until(lambda session: saved or stage.problems)
    assert stage.problems == []
    scene = saved[0]
    assert scene.last_frame == 8 and len(scene.simulation.events) == 5
    out = simulate(scene.simulation.model_dump(mode="json", exclude_none=True), 8, threads=1)
    assert bytes_in(out / "state_00008.npz") == stage.bytes()


def test_bad_values_are_refused_with_the_message_of_the_file_and_nothing_changes(stage):
    session = stage.session
    for data in (
        {"set": {"fluid.viscosity": -1}},
        {"set": {"fluid.viscocity": 1}},
        {"set": {"fps": 10}},
        {"remove": ["nobody"]},
        {"add": {"rigid": {"box": BOX}}},
        {"add": {"fluid": {"more": {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "position": [9, 0.1, 0]}}}},
        {"set": {"gravity": [float("nan"), 0, 0]}},
        {},
    ):
        stage.change(**data)
    session.step()
    stage.until(lambda session: session.status.frame >= 1 and session.status.mode == "paused")
    assert len(stage.problems) == 8, stage.problems
    text = "\n".join(stage.problems)
    for words in ("did you mean", "cannot change during", "there is no body named 'nobody'", "body named 'box'"):
        assert words in text, words
    assert session.spec == load(session.script.scene.path).simulation
    assert session._simulation.spec.events == ()


def test_a_problem_reads_as_in_the_file(stage, tmp_path):
    stage.change(set={"fluid.viscosity": -1})
    stage.until(lambda session: stage.problems)
    path = tmp_path / "scenes" / "bad.yaml"
    path.write_text(SCENE + "events:\n  - {at: 0.1, set: {fluid.viscosity: -1}}\n")
    with pytest.raises(SceneError) as wrong:
        load(path)
    (first, *_, last), (live_first, *_, live_last) = (
        text.splitlines() for text in (wrong.value.problems[0], stage.problems[0])
    )
    assert first.partition("events.0")[2] == live_first.partition("events.0")[2] != ""
    assert last == live_last


def test_what_stops_the_simulation_pauses_it_and_says_why(stage, monkeypatch):
    session = stage.session
    stage.step()
    with monkeypatch.context() as patch:
        fault = Fault("a fault of the test", "none helps", repeatable=False)
        patch.setattr("sim.run.stepping.find_fault", lambda world, measure, dt: fault if dt else None)
        stage.change(set={"gravity": [0, -5, 0]})
        session.play()
        stage.until(lambda session: session.status.problem and session.status.mode == "paused")
    assert "a fault of the test\nfix: none helps" in session.status.problem
    assert session.status.frame == 1
    session.go_back(0)
    stage.until(lambda session: session.status.frame == 0 and not session.status.problem)
    stage.step()
    assert session.status.frame == 1 and session._simulation.spec.events == ()


def test_it_keeps_to_its_speed(stage):
    session = stage.session
    stage.step()
    session.set_speed(0.05)
    session.play()
    began, simulated = time.perf_counter(), session.status.time
    time.sleep(1.5)
    session.pause()
    stage.until(lambda session: session.status.mode == "paused")
    assert (session.status.time - simulated) / (time.perf_counter() - began) < 0.07


def test_more_fluid_than_there_was_has_room(stage):
    """Three times as many particles."""
    session = stage.session
    stage.step()
    before = session.status.particles
    more = {"shape": {"type": "box", "size": [0.38, 0.3, 0.38]}}
    stage.change(add={"fluid": {"more": more | {"position": [0, 0.62, 0]}}})
    stage.step()
    stage.step()
    assert stage.problems == []
    assert session.status.particles > 1.8 * before
    assert set(np.unique(session.display.picture.body)) == {0, 1}
