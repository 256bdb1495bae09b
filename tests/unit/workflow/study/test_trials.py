"""Trials end, well or not, and say how; the report counts what failed."""

from __future__ import annotations

import csv
import json
import sys

import pytest

from sim.spec import SimulationSpec
from workflow.study import trial
from workflow.study.__main__ import main as report

BALL = {"shape": {"type": "sphere", "radius": 0.1}, "motion": "dynamic", "position": [0, 1, 0]}


def simulation(frames: str = "0:2", **settings) -> list[str]:
    """A command that simulates a ball."""
    spec = SimulationSpec.model_validate({"fps": 4, "rigid": {"bodies": {"ball": BALL}}, **settings}).canonical()
    words = [sys.executable, "-m", "sim.segment", "--spec", spec, "--folder", ".", "--frames", frames]
    return [*words, "--out", trial.RUN, "--threads", "1"]


def test_a_fall(tmp_path):
    found = trial.run("simulate", simulation(), tmp_path, limit=100)
    assert (found["status"], found["simulated_s"]) == ("done", 0.5)
    assert found["cost"] == pytest.approx(found["stepping_s"] / 0.5)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bodies.csv", "steps.csv", "summary.json"]


def test_what_is_refused_costs_nothing(tmp_path):
    found = trial.run("simulate", simulation(step={"fixed": 1.0}), tmp_path, limit=100)
    assert found["status"] == "refused"
    assert "cost" not in found
    assert "step.fixed" in found["message"]


def test_what_takes_too_long_is_given_up_at_its_cost(tmp_path):
    endless = simulation("0:4000", rigid={"bodies": {"ball": BALL}, "max_step": 1e-5})
    found = trial.run("simulate", endless, tmp_path, limit=12)
    assert found["status"] == "too long"
    # A machine under load may not have come to the first step.
    assert found.get("simulated_s", 0) < 1000


def test_a_crash_is_no_outcome(tmp_path, capsys):
    arguments = ["--stage", "simulate", "--out", str(tmp_path), "--", sys.executable, "-m", "sim.nothing"]
    assert trial.main(arguments) == 1
    assert "exit code 1" in capsys.readouterr().err


def test_surfaces_and_pictures_are_told_by_their_frames():
    surface = {"wall_s": {"splashsurf": 3.0}, "frames": [{"triangles": 5}, {"triangles": 7}]}
    assert trial.KINDS["reconstruct"].figures(surface) == {"cost": 1.5, "triangles": 7}
    picture = {"wall_s_per_frame": [2.0, 4.0], "device": {"kind": "CPU"}}
    assert trial.KINDS["render"].figures(picture) == {"cost": 3.0, "device": "cpu"}


TRIALS = {
    "a": {"status": "done", "cost": 1.0},
    "b": {"status": "done", "cost": 8.0},
    "c": {"status": "stopped", "cost": 2.0, "message": "what went wrong"},
    "d": {"status": "refused", "message": "no"},
}
HEIGHTS = {"a": 0.5, "b": 0.9}
STUDY = {
    "description": "test",
    "scene": "none",
    "grids": [{"rigid.max_step": ["1 ms", "2 ms", "3 ms", "4 ms"]}],
    "quantity": {"name": "height", "table": "bodies", "of": "ball", "column": "y"},
    "reference": {"type": "formula", "value": 1, "source": ""},
    "repeats": 1,
}


def written(folder) -> None:
    for name, outcome in TRIALS.items():
        place = folder / name / "0"
        place.mkdir(parents=True)
        place.joinpath("trial.json").write_text(json.dumps({"device": "cpu", **outcome}))
        if name in HEIGHTS:
            place.joinpath("bodies.csv").write_text(f"frame,time,body,y\n0,0,ball,3\n1,1,ball,{HEIGHTS[name]}\n")


def test_a_report(tmp_path, capsys):
    written(tmp_path / "trials")
    values = STUDY["grids"][0]["rigid.max_step"]
    trials = [[name, {"rigid.max_step": value}] for name, value in zip(TRIALS, values, strict=True)]
    settings = json.dumps({"name": "fall", "study": STUDY, "trials": trials, "truth": None})
    out = tmp_path / "out"
    arguments = ["--spec", settings, "--trials", str(tmp_path / "trials"), "--folder", ".", "--out", str(out)]
    assert report(arguments) == 0
    assert capsys.readouterr().out.split()[:2] == ["50", "%"]
    with (out / "points.csv").open() as file:
        rows = {row["rigid.max_step"]: row for row in csv.DictReader(file)}
    assert [rows[value]["status"] for value in values] == ["done", "done", "stopped", "refused"]
    assert [rows[value]["on_front"] for value in values] == ["1", "1", "0", "0"]
    assert float(rows["2 ms"]["error"]) == pytest.approx(0.1)
    assert (rows["3 ms"]["cost"], rows["3 ms"]["error"], rows["4 ms"]["cost"]) == ("2", "", "")
    summary = json.loads((out / "summary.json").read_text())
    assert summary["status"] == {"done": 2, "refused": 1, "stopped": 1}
    assert summary["failures"][0]["message"] == "what went wrong"
    assert (out / "work_precision.png").stat().st_size > 10_000
    assert "</svg>" in (out / "work_precision.svg").read_text()
