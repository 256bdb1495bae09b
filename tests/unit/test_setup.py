"""Which Python `setup.sh` takes, and what is pinned for each."""

from __future__ import annotations

import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
PYTHONS = ("3.11", "3.12", "3.13")
STOPPED = 9
"""Exit status of the interpreters below, when they are to make an environment."""
PYTHON = f"""#!/bin/sh
case "$1$2" in
    *version_info*) echo VERSION ;;
    -c*) echo "Python VERSION at $0" ;;
    *) exit {STOPPED} ;;
esac
"""


@pytest.fixture
def set_up(tmp_path):
    """Runs `setup.sh` where only these programs are: interpreters by name and version, perhaps a Blender."""

    def run(programs: dict[str, str], **environment: str) -> subprocess.CompletedProcess:
        folder = tmp_path / "a folder"
        folder.mkdir()
        for name, version in {**programs, "dirname": "", "rm": ""}.items():
            place = folder / name
            if shutil.which(name) and not version:
                place.symlink_to(shutil.which(name))
            else:
                place.write_text(PYTHON.replace("VERSION", version))
                place.chmod(0o755)
        shutil.copy(ROOT / "setup.sh", tmp_path)
        shell = shutil.which("sh")
        return subprocess.run(
            [shell, "setup.sh"], cwd=tmp_path, env={"PATH": str(folder), **environment}, capture_output=True, text=True
        )

    return run


@pytest.mark.parametrize(
    ("there", "taken"),
    [
        ({"python3.11": "3.11", "python3.13": "3.13", "python3": "3.13"}, "python3.11"),
        ({"python3.13": "3.13", "python3": "3.14"}, "python3.13"),
        ({"python3": "3.13"}, "python3"),
        ({"python3": "3.14", "python3.12": "3.12", "blender": "5.2"}, "python3.12"),
        ({"python3": "3.12", "blender": "5.2"}, "python3"),
    ],
    ids=str,
)
def test_whichever_is_there_is_taken(set_up, there, taken):
    done = set_up(there)
    assert done.returncode == STOPPED, done.stderr
    assert done.stdout.startswith("setting up .venv with Python ")
    assert done.stdout.endswith(f"/a folder/{taken}\n")


@pytest.mark.parametrize(
    "there", [{}, {"python3": "3.10"}, {"python3": "3.14"}, {"python3": "3.12", "python3.12": "3.12"}], ids=str
)
def test_none_is_told_with_a_remedy(set_up, there):
    done = set_up(there)
    assert done.returncode == 1
    assert "needs Python 3.11 or 3.13, or 3.12 and an installed Blender" in done.stderr
    assert "fix: install one" in done.stderr and "PYTHON=/path/to/python3.13 ./setup.sh" in done.stderr


def test_the_one_that_is_named_is_taken(set_up, tmp_path):
    named = tmp_path / "my python"
    named.write_text(PYTHON.replace("VERSION", "3.13"))
    named.chmod(0o755)
    assert set_up({"python3.11": "3.11"}, PYTHON=str(named)).stdout.endswith("/my python\n")


def test_one_that_is_named_and_too_new_is_refused(set_up):
    done = set_up({"python3.11": "3.11", "python3.14": "3.14"}, PYTHON="python3.14")
    assert (done.returncode, "looked for: python3.14" in done.stderr) == (1, True)


@pytest.mark.parametrize("python", PYTHONS)
def test_all_that_is_asked_for_is_pinned_within_its_bounds(python):
    """One version of each, and no address: where packages come from is for whoever installs to say."""
    lines = (ROOT / "constraints" / f"{python}.txt").read_text().splitlines()
    pinned = {name.lower().replace("_", "-"): version for name, version in (line.split("==") for line in lines)}
    extras = PROJECT["optional-dependencies"].values()
    asked = [Requirement(text) for text in [*PROJECT["dependencies"], *(text for extra in extras for text in extra)]]
    others = [one for one in asked if one.name != PROJECT["name"]]
    wanted = [one for one in others if one.marker is None or one.marker.evaluate({"python_version": python})]
    assert len(wanted) > 30
    for one in wanted:
        assert pinned[one.name.lower().replace("_", "-")] in one.specifier, one


def test_every_python_that_may_be_taken_has_its_versions():
    from packaging.specifiers import SpecifierSet

    allowed = SpecifierSet(PROJECT["requires-python"])
    assert [version for version in (f"3.{minor}" for minor in range(20)) if version in allowed] == list(PYTHONS)
    assert sorted(path.stem for path in (ROOT / "constraints").iterdir()) == list(PYTHONS)
