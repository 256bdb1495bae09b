"""Which measured settings can be trusted with an error, and how they become those of a scene."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from scene.load import load
from scene.settings import Refused
from workflow.accuracy import evidence as source
from workflow.accuracy.choose import needed
from workflow.accuracy.evidence import Measured, cheapest, least_error
from workflow.budget.spacings import FLUID, fineness_of_spacing, fluid_size
from workflow.plan.shelf import STUDY_FILES
from workflow.study.load import load_study

ROOT = Path(__file__).resolve().parents[4]
"""Of the project: its folder scenes/ is looked at."""


def measured(spacings: float, cfl: float, error: float | None, cost: float) -> Measured:
    return Measured("some", {"step.cfl": cfl}, {FLUID: spacings, "step.cfl": 1 / cfl}, {}, error, cost)


POINTS = [
    measured(10, 0.8, 0.02, 1.0),
    measured(10, 0.4, 0.09, 2.0),
    measured(20, 0.8, 0.05, 8.0),
    measured(20, 0.4, 0.04, 16.0),
]


def test_errors_that_are_small_by_chance_do_not_count():
    """The first has the least error, but the same spacing with shorter steps has more."""
    assert cheapest(POINTS, 0.1) is POINTS[0]
    assert cheapest(POINTS, 0.06) is POINTS[2]
    assert cheapest(POINTS, 0.04) is POINTS[3]
    assert cheapest(POINTS, 0.03) is None
    assert least_error(POINTS) == 0.04


def test_of_settings_that_cost_as_much_those_of_the_scene_are_kept():
    changed, kept = replace(POINTS[2], changes=1), replace(POINTS[3], cost=1.2 * POINTS[2].cost)
    assert cheapest([changed, kept], 0.06) is kept
    assert cheapest([changed, replace(kept, cost=1.3 * POINTS[2].cost)], 0.06) is changed


def test_settings_whose_finer_ones_fail_are_not_trusted():
    points = [*POINTS[:3], measured(20, 0.4, None, 16.0)]
    assert cheapest(points, 0.9) is None
    assert least_error(points) == float("inf")
    points = [*POINTS, measured(5, 1.6, None, 0.1)]
    assert cheapest(points, 0.1) is POINTS[0]


def test_a_column_twice_as_large_has_spacings_twice_as_large(monkeypatch):
    monkeypatch.chdir(ROOT)
    scene = load(Path("scenes/bench/column.yaml"))
    larger = load(Path("scenes/bench/column.yaml"), overrides=LARGER)
    assert fluid_size(scene) == pytest.approx((0.2 * 0.4 * 0.2) ** (1 / 3), rel=1e-6)
    assert fineness_of_spacing(larger, FLUID) == pytest.approx(2 * fineness_of_spacing(scene, FLUID), rel=1e-6)


LARGER = [
    "containers.tank.size=[0.4, 1.2, 0.4]",
    "fluid.bodies.water={shape: {type: box, size: [0.4, 0.8, 0.4]}, position: [0, 0.4, 0]}",
]


STUDY = f"""\
description: A study whose errors are known.
scene: {ROOT}/scenes/bench/sloshing.yaml
speaks_for: fluid
grids:
  - fluid.solver: [wcsph, dfsph]
    fluid.particle_radius: [10 mm, 6.25 mm, 5 mm]
    step.cfl: [0.8, 0.4, 0.2]
quantity: {{name: height, of: crest, column: water_height}}
reference: {{type: formula, value: 0.2, source: none}}
"""


@pytest.fixture
def tables(monkeypatch, tmp_path):
    """Of the one study that speaks for fluid: errors go as spacing and CFL number squared."""
    monkeypatch.chdir(ROOT)
    path = tmp_path / "scenes" / "studies" / "known.yaml"
    path.parent.mkdir(parents=True)
    path.write_text(STUDY)
    monkeypatch.setattr(source, "STUDY_FILES", replace(STUDY_FILES, folder=path.parent))
    monkeypatch.setattr(source, "STUDIES", str(tmp_path / "studies"))
    table = tmp_path / "studies" / "known" / "points.csv"
    table.parent.mkdir(parents=True)
    with table.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["trial", "status", "error", "cost"])
        for trial in load_study(path, "known").trials:
            spacing, cfl = trial.scene.simulation.fluid.spacing, trial.scene.simulation.step.cfl
            rows.writerow([trial.name, "done", spacing / 0.01 * 0.05 + cfl**2 * 0.05, 1 / spacing**4 / cfl])


def test_a_scene_gets_the_spacing_and_the_step_that_its_error_needs(tables):
    """An error of 0.06 is 0.05 by the spacing of 10 mm, and 0.008 by a CFL number of 0.4; a scene of the basin's shape
    at another spacing gets what the basin had."""
    coarse = load(Path("scenes/bench/sloshing.yaml"), overrides=["fluid.particle_radius=20 mm"])
    found = needed(coarse, 0.06)
    assert found.spacings == {FLUID: pytest.approx(0.005, rel=1e-3)}
    assert found.others == {"step.cfl": 0.4}
    assert "5.8 % in study known with step.cfl 0.4" in found.reasons[0]


def test_spacings_are_no_coarser_than_those_of_the_draft(tables, tmp_path):
    text = Path("scenes/bench/sloshing.yaml").read_text()
    path = tmp_path / "scenes" / "sloshing.yaml"
    path.write_text(text + "presets: {draft: {fluid: {particle_radius: 4 mm}}}\n")
    assert needed(load(path), 0.06).spacings == {FLUID: 0.004}


def test_what_no_study_found_is_refused(tables):
    scene = load(Path("scenes/bench/sloshing.yaml"))
    with pytest.raises(Refused, match="no setting of study known") as refused:
        needed(scene, 0.01)
    assert "5.2 % or more" in refused.value.remedy
    other = load(Path("scenes/bench/sloshing.yaml"), overrides=["fluid.solver=pcisph"])
    with pytest.raises(Refused, match="no study speaks for fluid"):
        needed(other, 0.5)


def test_zero_is_finer_than_all_else_and_truths_are_as_names(tables):
    scene = load(Path("scenes/bench/sloshing.yaml"), overrides=["fluid.xsph=0"])
    names = {"fluid.solver": scene.simulation.fluid.solver}
    coarse = Measured("some", {"fluid.xsph": 0.1}, {"fluid.xsph": 10.0}, names, 0.1, 1.0)
    found = source._beside(coarse, scene.simulation.model_dump(mode="json"))
    assert found.changes == 1
    none = replace(coarse, chosen={"fluid.xsph": 0}, fineness={"fluid.xsph": source._fineness("fluid.xsph", 0)})
    assert source._beside(none, scene.simulation.model_dump(mode="json")).changes == 0
    assert none.finer(coarse) and not coarse.finer(none)
