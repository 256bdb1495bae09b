"""Whatever a scene says, files are written in the project, and never through links that lead out of it."""

from __future__ import annotations

import pytest
import trimesh

from live.origin import is_own
from live.playing.script import Script
from live.uploads import keep
from scene.load import load
from scene.settings import Refused

ELSEWHERE = {
    **dict.fromkeys(["../film.mp4", "/tmp/film.mp4", "link/film.mp4", "film.mp4"], "outside of the project's folder"),
    **dict.fromkeys(["renders/film.mp4", ".git/film.mp4"], "the workflow manages"),
}


@pytest.mark.parametrize("place", ELSEWHERE)
def test_a_film_is_not_copied_elsewhere(stranger, place):
    (stranger.project / "link").symlink_to(stranger.home)
    (stranger.project / "film.mp4").symlink_to(stranger.home / "film.mp4")
    stranger.write(f"film: {{copy_to: {place}}}\n")
    stranger.refused("film.copy_to", ELSEWHERE[place])


@pytest.mark.parametrize("place", ["film.txt", "Snakefile", "film.mp4/../x.py", '"a\\0.mp4"'])
def test_a_copy_is_a_film(stranger, place):
    stranger.write(f"film: {{copy_to: {place}}}\n")
    stranger.refused("film.copy_to")


@pytest.mark.parametrize("name", ["../ball", "/ball", "a/b", "-ball", "~", "a\\0", "a\\nb", "$(id)", "a;b", ""])
@pytest.mark.parametrize("group", ["rigid: {bodies: {NAME: {shape: {type: sphere, radius: 0.1}}}}", "probes"])
def test_names_that_become_files_are_words(stranger, group, name):
    if group == "probes":
        stranger.write(f'probes: {{"{name}": {{type: front, axis: x}}}}\n')
    else:
        stranger.scene.write_text(f"duration: 1\n{group.replace('NAME', chr(34) + name + chr(34))}\n")
    stranger.refused("probes" if group == "probes" else "rigid.bodies")


def test_what_was_played_is_not_saved_through_a_link(stranger):
    scene = load(stranger.write())
    path = stranger.folder / "scene_live.yaml"
    path.symlink_to(stranger.home / "written.yaml")
    with pytest.raises(FileExistsError):
        Script(scene).save(path, (), 1)
    assert not (stranger.home / "written.yaml").exists()


def test_uploads_are_not_kept_through_a_link(stranger):
    ball = trimesh.creation.icosphere(1, 0.1).export(file_type="stl")
    uploads = stranger.folder / "uploads"
    uploads.symlink_to(stranger.home)
    with pytest.raises(Refused, match="is a link"):
        keep("ball.stl", ball, uploads)
    uploads.unlink()
    uploads.mkdir()
    (uploads / "ball.stl").symlink_to(stranger.home / "written.stl")
    assert keep("../../ball.stl", ball, uploads).name == "ball1.stl"
    assert not (stranger.home / "written.stl").exists()


PAGES = [
    ("http://127.0.0.1:8080", "127.0.0.1:8080", True),
    ("http://localhost:9000", "localhost:9000", True),  # a tunnel
    (None, "127.0.0.1:8080", True),  # no browser
    ("https://evil.example", "127.0.0.1:8080", False),
    ("http://evil.example:8080", "evil.example:8080", False),  # a name that was made to lead here
    ("http://127.0.0.1:3000", "127.0.0.1:8080", False),  # another page of this machine
    ("http://127.0.0.1.evil.example:8080", "127.0.0.1.evil.example:8080", False),
    ("null", "127.0.0.1:8080", False),
    ("http://[", "127.0.0.1:8080", False),
]


@pytest.mark.parametrize(("page", "host", "own"), PAGES)
def test_no_other_page_plays_a_scene(page, host, own):
    assert is_own({"Host": host} | ({} if page is None else {"Origin": page})) == own
