"""`snakemake studies/NAME`: every combination of settings, and what failed, in one table and one picture."""

from __future__ import annotations

import csv
import json

import pytest

from tests.support import falling_ball

STUDY = """\
description: How exact is free fall?
scene: ../fall.yaml
grids:
  - rigid.max_step: [50 ms, 10 ms]
  - step.fixed: [1 s]
quantity: {name: height, table: bodies, of: ball, column: y}
reference: {type: formula, value: 1 - g * 0.5**2 / 2, where: {g: 9.81}, source: Galilei 1638}
repeats: 1
"""
TARGET = "studies/fall"


@pytest.fixture
def study(fresh):
    """A project with a study that was not made."""
    folder = fresh.folder / "scenes" / "studies"
    folder.mkdir()
    folder.joinpath("fall.yaml").write_text(STUDY)
    folder.with_name("fall.yaml").write_text(falling_ball.scene(0.5))
    return fresh


def points(project) -> list[dict[str, str]]:
    with project.folder.joinpath(TARGET, "points.csv").open() as file:
        return list(csv.DictReader(file))


def test_a_study_from_start_to_end(study):
    study.make(TARGET)
    coarse, fine, refused = points(study)
    # Where bodies move by their mean velocity, a fall is exact; by their last one, it is off by g t dt / 2.
    assert [coarse["status"], fine["status"], refused["status"]] == ["done", "done", "refused"]
    assert float(coarse["error"]) < 9.81 * 0.5 * 0.05 / 2 / abs(1 - 9.81 / 8) * 1.01
    assert float(coarse["cost"]) > 0
    summary = json.loads(study.folder.joinpath(TARGET, "summary.json").read_text())
    assert summary["status"] == {"done": 2, "refused": 1}
    assert "step.fixed" in summary["failures"][0]["message"]
    assert study.dry_run(TARGET).nothing

    file = study.folder / "scenes" / "studies" / "fall.yaml"
    study.edit("g: 9.81", "g: 9.80665", file)
    assert study.dry_run(TARGET).stages == {"study"}
    study.edit("[50 ms, 10 ms]", "[50 ms, 20 ms, 10 ms]", file)
    again = study.dry_run(TARGET)
    assert sorted(stage for stage, _, _ in again.jobs) == ["study", "trial"]
    study.append("sim/rigid/model.py", "\n")
    assert [stage for stage, _, _ in study.dry_run(TARGET).jobs].count("trial") == 4
    study.folder.joinpath(TARGET, "points.csv").unlink()
    assert "study" in study.dry_run(TARGET).stages


@pytest.mark.parametrize(
    ("target", "words"),
    [("studies/fail", "did you mean studies/fall?"), ("results/studies/fall/00000000/0", "has no trial 00000000")],
)
def test_what_is_not_there_is_named(study, target, words):
    ran = study.snakemake("--dry-run", target)
    assert ran.code == 1
    assert words in ran.text
    assert "Traceback" not in ran.text


def test_a_wrong_study_is_refused_with_its_line(study):
    study.edit("column: y", "column: y, take: middle", study.folder / "scenes" / "studies" / "fall.yaml")
    ran = study.snakemake("--dry-run", TARGET)
    assert ran.code == 1
    assert "fall.yaml:6: quantity.take" in ran.text
    assert "Traceback" not in ran.text
