"""What the jobs of a scene depend on."""

from __future__ import annotations

import dataclasses
import json
import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest

from render.spec import RenderSpec
from sim.foam.spec import FoamSpec
from sim.spec import SimulationSpec
from workflow.plan.jobs import Plan
from workflow.stages.film.spec import FilmSpec
from workflow.stages.surface.spec import SurfaceSpec

ROOT = Path(__file__).resolve().parents[4]
BOX = {"type": "box", "size": [1, 1, 1]}
WATER = {"particle_radius": 0.1, "bodies": {"block": {"shape": BOX}}}
STONE = {"bodies": {"stone": {"motion": "static", "shape": BOX}}}


def scene(
    seconds: float = 2, surface: dict | None = None, render: dict | None = None, foam: dict | None = None, **simulation
):
    spec = SimulationSpec(fps=24, **simulation)
    return SimpleNamespace(
        name="pond",
        path=Path("scenes/pond.yaml"),
        folder=Path("scenes"),
        quality="standard",
        duration=seconds,
        simulation=spec,
        surface=SurfaceSpec(**(surface or {})),
        foam=None if foam is None else FoamSpec(**foam),
        render=RenderSpec(**(render or {})),
        film=FilmSpec(),
        assets={},
        last_frame=round(24 * seconds),
    )


def plan(**settings) -> Plan:
    return Plan(scene(**settings), ROOT)


def changed(before: Plan, after: Plan) -> set[str]:
    """Names of the jobs whose plan differs, or that are new."""
    stages = ("simulate", "reconstruct", "foam", "wet", "render", "film")
    old = {job.folder: job.plan for stage in stages for job in before.jobs(stage)}
    new = {job.folder: job.plan for stage in stages for job in after.jobs(stage)}
    return {name for name, digest in new.items() if old.get(name) != digest}


def test_parts_and_folders():
    made = plan(fluid=WATER)
    assert [job.folder for job in made.jobs("simulate")] == [
        f"results/pond/standard/simulation/00{k}" for k in range(4)
    ]
    assert str(made.job("simulate", 1).frames) == "13:24"
    assert len(made.jobs("render")) == 12
    assert made.job("film").folder == "renders/pond"


def test_the_same_scene_gives_the_same_plans():
    assert not changed(plan(fluid=WATER), plan(fluid=WATER))


def test_a_render_setting_changes_the_frames_and_the_film():
    found = changed(plan(fluid=WATER), plan(fluid=WATER, render={"samples": 7}))
    assert {name.split("/")[-2] for name in found} == {"frames", "renders"}


def test_a_longer_film_changes_no_segment():
    found = changed(plan(fluid=WATER), plan(fluid=WATER, seconds=3))
    assert found == {
        *(f"results/pond/standard/{kind}/00{k}" for kind in ("simulation", "surface") for k in (4, 5)),
        *(f"results/pond/standard/frames/{b:03d}" for b in range(12, 18)),
        "renders/pond",
    }


def test_an_event_changes_the_segments_after_it():
    event = {"at": 1.2, "set": {"gravity": [0, 0, 0]}}
    found = changed(plan(fluid=WATER), plan(fluid=WATER, events=[event]))
    assert {name for name in found if "simulation" in name} == {
        f"results/pond/standard/simulation/00{k}" for k in (2, 3)
    }


def test_without_fluid_there_is_nothing_to_reconstruct():
    dry = plan(rigid=STONE)
    assert dry.jobs("reconstruct") == []
    with pytest.raises(IndexError, match="no fluid"):
        dry.job("reconstruct", 0)


def test_values_of_one_job_differ_in_kind():
    job = plan(fluid=WATER).job("render", 0)
    values = [job.spec, job.code, job.versions, job.assets, job.plan, str(job.frames)]
    kinds = [value.split(" ")[0][:8] if not value.startswith("{") else "{" for value in values]
    assert len(set(kinds)) == len(values)


@pytest.mark.parametrize("field", ["spec", "code", "versions", "assets", "upstream"])
def test_the_plan_covers_every_value(field):
    job = plan(fluid=WATER).job("simulate", 1)
    other = dataclasses.replace(job, **{field: ("plan x",) if field == "upstream" else "x"})
    assert other.plan != job.plan


def test_the_compiler_that_is_used_counts(monkeypatch):
    def told(stage: str) -> str:
        return plan(fluid=WATER, foam={}).job(stage).versions

    stages = ("simulate", "foam")
    assert all(told(stage).startswith("versions taichi ") for stage in stages)
    monkeypatch.setenv("TIDEMILL_COMPILER", "quadrants")
    assert all(told(stage).startswith("versions quadrants ") and "taichi" not in told(stage) for stage in stages)


def test_code_of_cloth_counts_for_scenes_with_cloth_only(tmp_path):
    for package in ("sim", "render", "workflow"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    cloth = {"sheets": {"towel": {"shape": {"type": "sheet", "size": [1, 1]}, "spacing": 0.1}}}

    def codes() -> tuple[str, str]:
        return tuple(Plan(made, tmp_path).job("simulate").code for made in (scene(fluid=WATER), scene(cloth=cloth)))

    before = codes()
    spec = tmp_path / "sim" / "cloth" / "spec.py"
    spec.write_text(spec.read_text() + "\n# an edit\n")
    after = codes()
    assert after[0] == before[0]
    assert after[1] != before[1]


def test_foam_changes_foam_pictures_and_film_alone():
    found = changed(plan(fluid=WATER, foam={}), plan(fluid=WATER, foam={"seed": 1}))
    assert {folder.split("/")[-2] for folder in found} == {"foam", "frames", "renders"}


def test_walls_of_foam_are_those_of_the_scene():
    floor = {"bodies": {"floor": {"shape": {"type": "plane"}, "position": [0, -0.5, 0]}}}
    pool = {"pool": {"type": "box", "size": [2, 1, 4], "position": [1, 0, 0]}}
    spec = json.loads(plan(fluid=WATER, foam={}, rigid=floor, containers=pool).job("foam").spec)
    found = {(*wall["normal"], wall["offset"]) for wall in spec["walls"]}
    sides = {(1, 0, 0, 0), (-1, 0, 0, -2), (0, 1, 0, 0), (0, 0, 1, -2), (0, 0, -1, -2)}
    assert found == {(0, 1, 0, -0.5), *sides}


def test_there_is_no_foam_without_the_setting():
    with pytest.raises(IndexError, match="has no `foam:`"):
        plan(fluid=WATER).job("foam")
    assert plan(fluid=WATER).jobs("foam") == []


def test_a_surface_knows_times_and_sources_only_where_it_is_asked_for_them():
    """Also sources that an event adds later, so that all files of a film have the same columns."""
    tap = {"shape": {"type": "disc", "radius": 0.5}, "speed": 1}
    water = WATER | {"emitters": {"hose": tap}}
    events = [{"at": 1, "add": {"emitters": {"tap": tap}, "fluid": {"drop": {"shape": BOX}}}}]
    asked = ("age", "source")
    specs = [
        json.loads(plan(fluid=water, events=events, surface={"attributes": names}).job("reconstruct", 0).spec)
        for names in ((), asked[:1], asked[1:])
    ]
    assert [(spec.get("fps"), spec.get("sources")) for spec in specs] == [
        (None, None),
        (24, None),
        (None, ["block", "hose", "drop", "tap"]),
    ]


def test_a_palette_repeats_no_surface():
    water = [{"type": "palette", "colors": {"block": color}} for color in ("#ff0000", "#00ff00")]
    before, after = (plan(fluid=WATER, surface={"attributes": ["source"]}, render={"water": look}) for look in water)
    assert {name.split("/")[-2] for name in changed(before, after)} == {"frames", "renders"}


def test_drying_changes_what_is_wet_pictures_and_film_alone():
    slow, fast = ({"wetness": {"drying_time": seconds}} for seconds in (10, 2))
    found = changed(plan(fluid=WATER, render=slow), plan(fluid=WATER, render=fast))
    assert {folder.split("/")[-2] for folder in found} == {"wet", "frames", "renders"}
    found = changed(plan(fluid=WATER, render=slow), plan(fluid=WATER, render=slow, surface={"cube_size": 0.9}))
    assert {folder.split("/")[-2] for folder in found} == {"surface", "frames", "renders"}


def test_nothing_gets_wet_without_the_setting():
    with pytest.raises(IndexError, match=r"has no `render\.wetness`"):
        plan(fluid=WATER).job("wet")
    assert plan(fluid=WATER).jobs("wet") == []
    made = plan(fluid=WATER, render={"wetness": {}})
    assert [job.folder for job in made.jobs("wet")] == [f"results/pond/standard/wet/{k:03d}" for k in range(4)]
    assert json.loads(made.job("wet").spec)["drying_time"] == 10


def test_containers_that_show_it_get_wet():
    looks = {"tub": {"type": "tiles"}, "tank": {"type": "glass"}}
    tanks = {name: {"type": "box", "size": [2, 2, 2]} for name in ("tub", "tank", "undrawn")}
    made = plan(fluid=WATER, containers=tanks, render={"wetness": {}, "materials": looks})
    assert json.loads(made.job("wet").spec)["vessels"] == ["tub"]
