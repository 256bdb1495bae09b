"""Manifests, and what is made of them and of Snakemake's record."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from common.frames import Frames
from common.manifest import Manifest, damage, spoiled
from workflow.plan import record
from workflow.plan.jobs import Job
from workflow.plan.results import Unrecorded, refuse_unrecorded, repairs

JOB = Job(
    stage="film", folder="renders/a", frames=Frames(0, 1), spec="{}", code="code 1", versions="versions 1", assets=""
)


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    made = tmp_path / JOB.folder
    (made / "frames").mkdir(parents=True)
    (made / "a.mp4").write_bytes(b"12345")
    (made / "frames" / "0.png").write_bytes(b"123")
    Manifest.of(made, JOB.plan).write(made)
    return made


def remember(*params: str) -> None:
    path = record.metadata_file(JOB.folder)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"params": [repr(value) for value in params]}))


def test_a_complete_folder_is_not_damaged(folder):
    (folder / "notes.txt").write_text("a file of the user")
    (folder / ".snakemake_timestamp").touch()
    assert damage(folder) == ""


@pytest.mark.parametrize("name", ["a.mp4", "frames/0.png"])
def test_missing_and_truncated_files_are_damage(folder, name):
    (folder / name).write_bytes(b"1")
    assert f"{name} has 1 bytes" in damage(folder)
    (folder / name).unlink()
    assert damage(folder) == f"{name} is missing"


def zero(path: Path, *, unnoticed: bool = False) -> None:
    """Other bytes, as many; `unnoticed` keeps the time, as a disk does that fails."""
    state = path.stat()
    path.write_bytes(bytes(state.st_size))
    if unnoticed:
        os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))


@pytest.mark.parametrize("name", ["a.mp4", "frames/0.png"])
def test_another_content_of_the_same_size_is_damage(folder, name):
    zero(folder / name)
    assert damage(folder) == f"{name} has another content"


def test_a_touched_file_is_no_damage(folder):
    os.utime(folder / "a.mp4", ns=(1, 1))
    assert damage(folder) == ""


def test_what_was_not_written_to_is_not_read_anew(folder):
    """Or to look for what is to be done would take as long as to read all results."""
    zero(folder / "a.mp4", unnoticed=True)
    assert damage(folder) == ""


def test_a_manifest_of_before_there_were_sums(folder):
    (folder / "manifest.json").write_text(json.dumps({"plan": JOB.plan, "files": {"a.mp4": 5}}))
    zero(folder / "a.mp4")
    assert damage(folder) == ""
    assert spoiled(folder, ("",)) is None


def test_who_reads_files_finds_what_was_spoiled(tmp_path):
    for name in ("fluid_00001.ply", "fluid_00002.ply", "cloth_a_00001.ply", "bodies.csv"):
        (tmp_path / name).write_bytes(b"123")
    Manifest.of(tmp_path, "plan").write(tmp_path)
    assert spoiled(tmp_path, ("fluid_", "bodies"), range(3)) is None
    zero(tmp_path / "fluid_00002.ply", unnoticed=True)
    assert spoiled(tmp_path, ("fluid_",), range(3)) == tmp_path / "fluid_00002.ply"
    assert spoiled(tmp_path, ("fluid_",), [1]) is None
    assert spoiled(tmp_path, ("cloth_",), range(3)) is None
    zero(tmp_path / "bodies.csv", unnoticed=True)
    assert spoiled(tmp_path, ("bodies",), [1]) == tmp_path / "bodies.csv"
    (tmp_path / "bodies.csv").unlink()
    assert spoiled(tmp_path, ("bodies",), [1]) is None


@pytest.mark.parametrize("text", ["", "{", "[]", '{"plan": "x"}', '{"plan": "x", "files": 3}'])
def test_a_broken_manifest_is_damage(folder, text):
    (folder / "manifest.json").write_text(text)
    assert "manifest.json" in damage(folder)


def test_repairs_count_on_only_while_something_is_missing(folder):
    remember("repairs 3", "{}")
    assert repairs(JOB) == "repairs 3"
    assert repairs(JOB, complete=False) == "repairs 4"
    (folder / "a.mp4").unlink()
    assert repairs(JOB) == "repairs 4"


def test_a_folder_that_is_not_there_needs_no_repair(folder):
    remember("repairs 2")
    for path in (folder / "frames" / "0.png", folder / "a.mp4", folder / "manifest.json"):
        path.unlink()
    (folder / "frames").rmdir()
    folder.rmdir()
    assert repairs(JOB) == "repairs 2"


def test_results_without_a_record_must_be_what_is_asked_for(folder):
    refuse_unrecorded([JOB])
    (folder / "a.mp4").unlink()
    with pytest.raises(Unrecorded, match="rm -r renders/a"):
        refuse_unrecorded([JOB])
    remember("repairs 0")
    refuse_unrecorded([JOB])


def test_a_job_that_never_ended_is_left_to_snakemake(folder):
    (folder / "a.mp4").unlink()
    marker = record.metadata_file(JOB.folder, "incomplete")
    marker.parent.mkdir(parents=True)
    marker.touch()
    refuse_unrecorded([JOB])


def test_long_paths_are_found_in_the_record(tmp_path):
    path = record.metadata_file("results/" + "x" * 400, workdir=tmp_path)
    assert all(len(part) < 256 for part in path.parts)
    assert path.parent.name.startswith("@")
