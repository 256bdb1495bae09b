"""What triggers what: each row of the design's table, with the reason that Snakemake prints."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from tests.pipeline.conftest import TARGET
from tests.support import textured

EVERYTHING = {"simulate", "reconstruct", "render", "film"}
CHANGED = "Params have changed since last execution"
UPDATED = "Input files updated by another job"
SEGMENTS = ["0:4", "5:8"]


def assert_reruns(ran, stages: set[str], cause: str | None = None) -> None:
    """Exactly the jobs of `stages` run; those of `cause` by their params, the others by their inputs."""
    assert ran.stages == stages, ran.text
    if cause is not None:
        assert any(CHANGED in reason for reason in ran.reasons(cause)), ran.text
        for other in stages - {cause}:
            assert all(UPDATED in reason for reason in ran.reasons(other)), ran.text


def test_without_an_edit_nothing_runs(project):
    assert project.dry_run().nothing
    assert project.dry_run("renders/tests/pond/").nothing


def test_comments_order_spelling_and_touch_run_nothing(project):
    project.edit("fps: 4\n", "# frames\nfps:   4.0\n")
    project.edit("particle_radius: 0.05", "particle_radius: 5 cm")
    project.edit("  resolution: [65, 49]\n  samples: 1\n", "  samples: 1 # few\n  resolution:\n  - 65\n  - 49\n")
    os.utime(project.scene)
    os.utime(project.scene.with_name("stone.obj"))
    for source in project.folder.joinpath("sim").rglob("*.py"):
        os.utime(source)
    assert project.dry_run().nothing


@pytest.mark.parametrize(
    "setting",
    [
        "lights: {sun: {strength: 5}}",
        "camera: {azimuth: 50}",
        "water: {color: '#ff8800'}",
        "seed: 3",
        "materials: {stone: {type: plastic}}",
    ],
)
def test_a_setting_of_the_render_stage(project, setting):
    project.edit("  samples: 1\n", f"  samples: 1\n  {setting}\n")
    ran = project.dry_run()
    assert_reruns(ran, {"render", "film"}, "render")
    assert ran.frames("render") == SEGMENTS


def test_a_setting_of_the_surface(project):
    project.edit("cube_size: 1.0", "cube_size: 1.1")
    ran = project.dry_run()
    assert_reruns(ran, {"reconstruct", "render", "film"}, "reconstruct")
    assert ran.frames("reconstruct") == SEGMENTS


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("-9.81", "-1.62"),
        ("size: [0.3, 0.4, 0.5]", "size: [0.3, 0.5, 0.5]"),
        ("particle_radius: 0.05", "particle_radius: 0.04"),
        ("particle_radius: 0.05", "particle_radius: 0.05\n  viscosity: 0.01"),
    ],
)
def test_a_setting_of_the_simulation(project, old, new):
    project.edit(old, new)
    ran = project.dry_run()
    assert_reruns(ran, EVERYTHING)
    assert ran.frames("simulate") == SEGMENTS
    assert any(CHANGED in reason for reason in ran.reasons("simulate"))


def test_the_content_of_a_mesh_file(project):
    project.edit("0.1 0.1 0.1", "0.1 0.1 0.09", project.scene.with_name("stone.obj"))
    ran = project.dry_run()
    assert_reruns(ran, EVERYTHING)
    assert "assets" in ran.text


@pytest.fixture
def textured_film(project):
    """The film with a stone in the materials of its file, one image of which is on it."""
    folder = project.scene.parent
    (folder / "stone.mtl").write_text("newmtl rock\nmap_Kd rock.png\n")
    (folder / "rock.png").write_bytes(textured.picture())
    (folder / "rough.png").write_bytes(textured.picture())
    stone = folder / "stone.obj"
    stone.write_text(f"mtllib stone.mtl\nusemtl rock\n{stone.read_text()}")
    project.append(
        project.scene.relative_to(project.folder), "  ground: {material: {type: matte, texture: rough.png}}\n"
    )
    project.make()
    assert project.dry_run().nothing
    return project


def test_the_materials_of_a_mesh(textured_film):
    """A texture of the mesh file that changes, goes, or makes place for another look; the simulation is none of it."""
    scenes = textured_film.scene.parent
    picture, library = (scenes / "rock.png").read_bytes(), (scenes / "stone.mtl").read_text()
    (scenes / "rock.png").write_bytes(textured.picture("TIFF"))
    assert_reruns(textured_film.dry_run(), {"render", "film"}, "render")
    (scenes / "rock.png").write_bytes(picture)
    (scenes / "stone.mtl").write_text("newmtl rock\nKd 1 0 0\n")
    assert_reruns(textured_film.dry_run(), {"render", "film"}, "render")
    (scenes / "stone.mtl").write_text(library)
    (scenes / "rough.png").write_bytes(textured.picture("TIFF"))
    assert_reruns(textured_film.dry_run(), {"render", "film"}, "render")
    (scenes / "rough.png").write_bytes(picture)
    assert textured_film.dry_run().nothing
    (scenes / "rock.png").unlink()
    ran = textured_film.snakemake("--dry-run", TARGET)
    assert ran.code == 1 and "rigid.bodies.stone.shape.file" in ran.text


def test_a_longer_film_adds_segments(project):
    project.edit("duration: 2", "duration: 3")
    ran = project.dry_run()
    assert ran.stages == EVERYTHING
    assert ran.frames("simulate") == ran.frames("reconstruct") == ran.frames("render") == ["9:12"]


def test_a_shorter_film_makes_the_film_alone(project):
    project.edit("duration: 2", "duration: 1")
    assert_reruns(project.dry_run(), {"film"}, "film")


def test_a_later_event_spares_the_earlier_segments(project):
    project.append(project.scene.relative_to(project.folder), "events:\n- {at: 1.5, set: {gravity: [0, -1, 0]}}\n")
    ran = project.dry_run()
    assert ran.stages == EVERYTHING
    assert ran.frames("simulate") == ran.frames("render") == ["5:8"]


def test_playback_and_encoder(project):
    project.append(project.scene.relative_to(project.folder), "film: {playback_fps: 12}\n")
    assert_reruns(project.dry_run(), {"film"}, "film")


def test_a_lost_copy_of_the_film(project):
    project.append(project.scene.relative_to(project.folder), "film: {copy_to: gallery/pond.mp4}\n")
    assert_reruns(project.make(), {"film"}, "film")
    copy = project.folder / "gallery" / "pond.mp4"
    assert copy.read_bytes() == (project.film / "pond.mp4").read_bytes()
    assert project.dry_run().nothing
    copy.unlink()
    assert_reruns(project.dry_run(), {"film"}, "film")


@pytest.mark.parametrize(
    ("file", "stages"),
    [
        ("sim/fluid/spec.py", EVERYTHING),
        ("sim/segment.py", EVERYTHING),
        ("sim/cloth/spec.py", set()),
        ("workflow/stages/surface/surface.py", {"reconstruct", "render", "film"}),
        ("render/content/materials.py", {"render", "film"}),
        ("render/texturing/projection.py", {"render", "film"}),
        ("scene/imported/mtl.py", set()),
        ("workflow/stages/film/plots.py", {"film"}),
        ("workflow/job.py", set()),
        ("workflow/catalog.py", set()),
    ],
)
def test_source_files(project, file, stages):
    project.append(file, "\n# an edit\n")
    assert_reruns(project.dry_run(), stages)


@pytest.mark.parametrize(
    ("package", "stages"),
    [
        ("taichi", EVERYTHING),
        ("pysplashsurf", {"reconstruct", "render", "film"}),
        ("bpy", {"render", "film"}),
        ("imageio-ffmpeg", {"film"}),
    ],
)
def test_versions(project, package, stages):
    information = project.folder / "other" / f"{package.replace('-', '_')}-99.0.dist-info"
    information.mkdir(parents=True)
    (information / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 99.0\n")
    ran = project.dry_run(PYTHONPATH=str(information.parent))
    assert_reruns(ran, stages)
    assert f"{package} 99.0" in ran.text


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-1])


def zero(path: Path) -> None:
    path.write_bytes(bytes(path.stat().st_size))


@pytest.mark.parametrize("damage", [Path.unlink, truncate, zero])
def test_a_damaged_frame(project, damage):
    damage(project.results / "frames" / "001" / "00006.png")
    ran = project.dry_run()
    assert_reruns(ran, {"render", "film"}, "render")
    assert ran.frames("render") == ["5:8"]
    assert "repairs 1" in ran.text


@pytest.mark.parametrize("name", ["pond.mp4", "frames/00003.png", "contact.png", "manifest.json"])
def test_damage_in_the_film(project, name):
    (project.film / name).unlink()
    assert_reruns(project.dry_run(), {"film"}, "film")


def test_a_repair_is_remembered_and_can_be_repeated(project):
    for count in (1, 2):
        (project.film / "contact.png").unlink()
        ran = project.make()
        assert_reruns(ran, {"film"}, "film")
        assert f"repairs {count}" in ran.text
        assert project.dry_run().nothing


def test_a_dry_run_changes_no_file(project):
    (project.results / "frames" / "001" / "00006.png").unlink()

    def listing():
        kept = [project.results, project.film, project.folder / ".snakemake" / "metadata"]
        return sorted((str(path), path.stat().st_mtime_ns) for folder in kept for path in folder.rglob("*"))

    before = listing()
    project.dry_run()
    assert listing() == before


def test_without_intermediate_results_nothing_runs_until_an_edit(project):
    shutil.rmtree(project.folder / "results")
    assert project.dry_run().nothing
    project.edit("samples: 1", "samples: 2")
    assert_reruns(project.dry_run(), EVERYTHING)


def test_a_lost_record_is_no_licence_to_keep_what_is_out_of_date(project):
    shutil.rmtree(project.folder / ".snakemake")
    assert project.dry_run().nothing
    project.edit("-9.81", "-1.62")
    ran = project.snakemake("--dry-run", "renders/tests/pond")
    assert ran.code != 0
    assert "record" in ran.text
    assert "rm -r renders/tests/pond" in ran.text
    assert "Traceback" not in ran.text


def test_a_lost_record_does_not_hide_an_edit_of_an_earlier_stage(project):
    shutil.rmtree(project.folder / ".snakemake")
    shutil.rmtree(project.folder / "results")
    project.edit("-9.81", "-1.62")
    assert project.snakemake("--dry-run", "renders/tests/pond").code != 0


def test_another_quality_is_another_film(project):
    ran = project.dry_run("renders/tests/pond", "--config", "quality=draft")
    assert_reruns(ran, EVERYTHING)
    assert all("Missing output files" in reason for reason in ran.reasons("simulate"))


def test_threads_run_nothing(project):
    assert project.dry_run("renders/tests/pond", "--cores", "8").nothing


def test_a_scene_without_fluid_reconstructs_nothing(fresh):
    fresh.scene.with_name("dry.yaml").write_text(
        "duration: 0.5\nfps: 4\n"
        "rigid: {bodies: {ball: {motion: static, shape: {type: sphere, radius: 1}}}}\n"
        "render: {resolution: [64, 48], samples: 1}\n"
    )
    ran = fresh.make("renders/tests/dry")
    assert ran.stages == {"simulate", "render", "film"}
    assert (fresh.folder / "renders/tests/dry/dry.mp4").exists()
    assert not (fresh.folder / "results/tests/dry/standard/surface").exists()
    assert fresh.dry_run("renders/tests/dry").nothing
