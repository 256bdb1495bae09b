"""Study files: every combination is a valid scene, or the message names what is wrong."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from scene.document import SceneError
from scene.reader import read
from tests.support import falling_ball
from workflow.plan.jobs import ENTRY
from workflow.plan.shelf import STUDY_FILES
from workflow.study import schema
from workflow.study.load import load_study
from workflow.study.plan import StudyPlan

ROOT = Path(__file__).resolve().parents[4]
STUDY = """\
description: How exact is free fall?
scene: ../fall.yaml
grids:
  - rigid.max_step: [20 ms, 10 ms]
    rigid.max_iterations: [1, 5]
  - rigid.max_step: [5 ms]
quantity: {name: height, table: bodies, of: ball, column: y}
reference: {type: formula, value: 1 - 9.81 / 2, source: Galilei 1638}
repeats: 2
"""


@pytest.fixture
def loaded(tmp_path, monkeypatch):
    """Loads the study with parts of its text replaced."""
    folder = tmp_path / "scenes" / "studies"
    monkeypatch.chdir(tmp_path)

    def load(*replaced: tuple[str, str]):
        path = falling_ball.written(folder / "fall.yaml", STUDY, *replaced)
        folder.parent.joinpath("fall.yaml").write_text(falling_ball.scene(1))
        return load_study(path, "fall")

    return load


@pytest.mark.parametrize("name", STUDY_FILES.names(ROOT))
def test_the_studies_of_the_project_load(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert load_study(Path("scenes", "studies", f"{name}.yaml"), name).trials


def test_the_schema_is_up_to_date_and_studies_name_it_and_fit_it():
    assert (ROOT / schema.SCHEMA).read_text() == schema.text(), "run python -m workflow.study.schema"
    validator = jsonschema.Draft202012Validator(json.loads(schema.text()))
    for path in (ROOT / schema.SCHEMA).parent.glob("*.yaml"):
        assert path.read_text().startswith("# yaml-language-server: $schema=schema.json\n"), path
        validator.validate(read(path).data)


def test_every_combination_within_a_grid_is_a_trial(loaded):
    study = loaded()
    assert [trial.chosen for trial in study.trials] == [
        {"rigid.max_step": "20 ms", "rigid.max_iterations": 1},
        {"rigid.max_step": "20 ms", "rigid.max_iterations": 5},
        {"rigid.max_step": "10 ms", "rigid.max_iterations": 1},
        {"rigid.max_step": "10 ms", "rigid.max_iterations": 5},
        {"rigid.max_step": "5 ms"},
    ]
    assert [trial.scene.simulation.rigid.max_step for trial in study.trials] == [0.02, 0.02, 0.01, 0.01, 0.005]
    jobs = StudyPlan(study, ROOT).trials()
    assert len({job.folder for job in jobs}) == len(jobs) == 10


def changed(before, after) -> tuple[set[str], bool]:
    """Folders of trials whose plans are new, and whether the report's is."""
    old, new = StudyPlan(before, ROOT), StudyPlan(after, ROOT)
    plans = {job.folder: job.plan for job in old.trials()}
    return {job.folder for job in new.trials() if plans.get(job.folder) != job.plan}, old.report.plan != new.report.plan


def test_what_an_edit_repeats(loaded):
    base = loaded()
    assert changed(base, loaded()) == (set(), False)
    assert changed(base, loaded(("1 - 9.81 / 2", "1 - 9.8 / 2"))) == (set(), True)
    trials, report = changed(base, loaded(("[5 ms]", "[5 ms, 2 ms]")))
    assert (len(trials), report) == (2, True)
    trials, report = changed(base, loaded(("scene: ../fall.yaml", "scene: ../fall.yaml\nset: {gravity: [0, -1, 0]}")))
    assert (len(trials), report) == (10, True)


def test_a_study_may_be_compared_with_its_best_trial(loaded):
    reference = "reference: {type: trial, set: {rigid.max_step: 1 ms}}"
    study = loaded(("reference: {type: formula, value: 1 - 9.81 / 2, source: Galilei 1638}", reference))
    assert study.truth.scene.simulation.rigid.max_step == 0.001
    assert len(StudyPlan(study, ROOT).trials()) == 11


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("rigid.max_iterations: [1, 5]", "rigid.max_iteration: [1, 5]", "max_iterations"),
        ("[20 ms, 10 ms]", "[20 ms, -1 ms]", "max_step"),
        ("scene: ../fall.yaml", "scene: ../fill.yaml", "fall.yaml"),
        ("of: ball, column: y", "column: y", "of names the probe or the body"),
        ("1 - 9.81 / 2", "1 - g / 2", "reference.value|cannot be computed"),
        ("repeats: 2", "repeats: 0", "repeats"),
        ("repeats: 2", "color: gravity", "rigid.max_step"),
        ("grids:", "grid:", "grids"),
        ("description: How exact is free fall?\n", "", "description"),
        ("repeats: 2", "stage: render", "the stage render leaves no table bodies"),
        ("[5 ms]", "[5 ms]\n  - render.samples: [1]", "render.samples changes nothing in a simulation"),
        ("repeats: 2", "frame: 2", "frame is for surfaces and pictures"),
    ],
)
def test_what_is_wrong_is_named(loaded, old, new, words):
    with pytest.raises(SceneError) as error:
        loaded((old, new))
    assert "fall.yaml" in str(error.value)
    assert any(word in str(error.value) for word in words.split("|")), str(error.value)


@pytest.mark.parametrize(
    ("quantity", "more", "words"),
    [
        ("{name: shape, table: picture}", "stage: render\nframe: 5", "has no frame 5.*at most 4"),
        ("{name: volume, table: surface, column: volume}", "stage: reconstruct", "has no fluid"),
    ],
)
def test_a_frame_or_a_surface_that_is_not_there_is_refused(loaded, quantity, more, words):
    """Only after hours of simulation it would have been missed."""
    path = "surface.cube_size" if "reconstruct" in more else "render.samples"
    grids = STUDY[STUDY.index("grids:") : STUDY.index("quantity:")]
    lines = STUDY[STUDY.index("quantity:") : STUDY.index("repeats: 2")]
    trial = f"reference: {{type: trial, set: {{{path}: 2}}}}"
    with pytest.raises(SceneError, match=f"(?s)fall.yaml:.*{words}"):
        loaded(
            (grids, f"grids: [{{{path}: [1]}}]\n"), (lines, f"quantity: {quantity}\n{trial}\n"), ("repeats: 2", more)
        )


def test_films_know_nothing_of_studies():
    """Code of studies repeats no stage of a film."""
    from workflow.plan.sources import closure

    for stage in ("simulate", "reconstruct", "render", "film"):
        assert not [path for path in closure(ENTRY[stage], ROOT) if "study" in path.parts]
