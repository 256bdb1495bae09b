"""Versions are tags, and the changelog has a section for each."""

from __future__ import annotations

import re
import subprocess
import tomllib
from pathlib import Path

import pytest
from packaging.version import Version

ROOT = Path(__file__).resolve().parents[2]
RELEASES = re.findall(r"^## (\d+\.\d+\.\d+), \d{4}-\d\d-\d\d$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)


def git(*words: str) -> list[str]:
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.split()


def test_releases_are_in_order():
    versions = [Version(release) for release in RELEASES]
    assert versions and versions == sorted(set(versions), reverse=True)


def test_a_copy_without_tags_has_the_version_of_the_last_release():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert project["tool"]["hatch"]["version"]["fallback-version"] == RELEASES[0]


def test_every_tag_is_a_release_in_the_changelog():
    tags = git("tag", "--list", "v*")
    if not tags:
        pytest.skip("a copy without tags")
    assert {tag.removeprefix("v") for tag in tags} <= set(RELEASES)


@pytest.mark.parametrize("distance", [0, 2])
def test_the_version_comes_from_the_last_tag(tmp_path, distance):
    """As pip finds it: that of the tag at the tag, and one that counts the commits after it."""
    from hatchling.metadata.core import ProjectMetadata
    from hatchling.plugin.manager import PluginManager

    def commit(name: str) -> None:
        who = ("-c", "user.name=me", "-c", "user.email=me@example.org")
        words = ["git", *who, "commit", "--quiet", "--allow-empty", "--message", name]
        subprocess.run(words, cwd=tmp_path, check=True)

    subprocess.run(["git", "init", "--quiet"], cwd=tmp_path, check=True)
    (tmp_path / "pyproject.toml").write_text((ROOT / "pyproject.toml").read_text())
    (tmp_path / ".gitignore").write_text("pyproject.toml\n")
    commit("first")
    subprocess.run(["git", "tag", "v7.8.9"], cwd=tmp_path, check=True)
    for index in range(distance):
        commit(str(index))
    found = ProjectMetadata(str(tmp_path), PluginManager()).version
    assert found == "7.8.9" if distance == 0 else found.startswith("7.8.10.dev2+g")
