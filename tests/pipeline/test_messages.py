"""What someone reads who asks for something that cannot be made."""

from __future__ import annotations


def refused(ran, *words: str) -> None:
    assert ran.code != 0
    assert "Traceback" not in ran.text
    for word in words:
        assert word in ran.text, ran.text


def test_a_wrong_name_brings_the_close_ones(fresh):
    refused(fresh.snakemake("-n", "renders/tests/pont"), "no scene 'tests/pont'", "did you mean renders/tests/pond?")
    refused(fresh.snakemake("-n", "renders/pond"), "renders/tests/pond")
    refused(fresh.snakemake("-n", "renders/tests/pond/pond.mp4"), "renders/tests/pond")
    refused(fresh.snakemake("-n", "renders/zebra"), "the scenes are tests/pond")


def test_a_mistake_in_the_scene(fresh):
    fresh.edit("samples: 1", "samples: -1")
    refused(fresh.snakemake("--cores", "1", "renders/tests/pond"), "pond.yaml:18", "render.samples", "fix:")
    assert not (fresh.folder / "results").exists()


def test_a_copy_outside_of_the_project(fresh):
    fresh.append("scenes/tests/pond.yaml", "film: {copy_to: ../pond.mp4}\n")
    refused(fresh.snakemake("-n", "renders/tests/pond"), "copy_to", "outside")


def test_a_copy_among_the_results(fresh):
    fresh.append("scenes/tests/pond.yaml", "film: {copy_to: renders/pond.mp4}\n")
    refused(fresh.snakemake("-n", "renders/tests/pond"), "pond.yaml:19", "copy_to", "the workflow manages")


def test_wrong_configuration(fresh):
    refused(fresh.snakemake("-n", "renders/tests/pond", "--config", "quality=best"), "best", "draft, standard, final")
    refused(fresh.snakemake("-n", "renders/tests/pond", "--config", "qualty=draft"), "qualty", "quality")
    refused(fresh.snakemake("-n", "renders/tests/pond", "--config", "budget=soon"), "budget=soon", "10min")
    both = "--config", "budget=5min", "quality=draft"
    refused(fresh.snakemake("-n", "renders/tests/pond", *both), "quality and budget", "leave one of them out")
    refused(fresh.snakemake("-n", "renders/tests/pond", "--config", "error=0.05"), "error=0.05", "error=5%")
    refused(
        fresh.snakemake("-n", "renders/tests/pond", "--config", "error=5%"), "no study speaks for fluid", "speaks_for"
    )


def test_other_settings_than_those_of_the_scene(fresh):
    asked = "-n", "renders/tests/pond", "--config"
    ran = fresh.snakemake(*asked, 'set=["render.samples=2", "fps=12"]', "quality=draft")
    assert ran.code == 0
    assert "results/tests/pond/changed/frames/000" in ran.text
    refused(fresh.snakemake(*asked, "set=render.samples=2"), "no list of settings", "render.samples=32")
    refused(fresh.snakemake(*asked, 'set=["render.sampels=2"]'), "render.sampels", "did you mean 'samples'?")
    refused(fresh.snakemake(*asked, 'set=["fps=12"]', "budget=5min"), "budget and set", "leave one of them out")


def test_a_part_that_the_film_does_not_have(fresh):
    refused(fresh.snakemake("-n", "results/tests/pond/standard/simulation/007"), "no part 7 of 2")


def test_a_scene_named_like_a_folder_of_scenes(fresh):
    (fresh.folder / "scenes" / "tests.yaml").write_text(fresh.scene.read_text())
    refused(fresh.snakemake("-n", "renders/tests"), "rename one")


def test_without_a_target_the_scenes_are_listed(fresh):
    ran = fresh.snakemake()
    assert ran.code == 0
    assert "snakemake --cores all renders/NAME" in ran.text
    assert "renders/tests/pond  A block of water falls beside a stone." in ran.text
