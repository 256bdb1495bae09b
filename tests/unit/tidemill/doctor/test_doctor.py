"""`tidemill doctor`: what it says of a machine that is as it should be, and of one on which something is wrong."""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tidemill.doctor import machine, packages, report, stages
from tidemill.doctor.finding import State, ok, wrong
from tidemill.doctor.trial import attempt

EMPTY = ("-x", "c", "/dev/null", "-x", "none")
"""A source file for a C compiler."""
ROOT = Path(__file__).resolve().parents[4]


def doctor(*options: str, **how) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **how.pop("environment", {})}
    words = [sys.executable, "-m", "tidemill", "doctor", *options]
    return subprocess.run(words, env=environment, capture_output=True, text=True, **how)


def states(found) -> dict[str, State]:
    return {finding.subject: finding.state for finding in found}


@pytest.mark.slow
def test_films_can_be_made_here():
    done = doctor("--json")
    found = json.loads(done.stdout)
    assert done.returncode == 0, done.stdout
    assert {row["subject"] for row in found["findings"]} >= {"Python", "packages", "simulation", "encoder", "pictures"}
    assert {row["state"] for row in found["findings"]} <= {"ok", "warning"}
    (picture,) = (row["text"] for row in found["findings"] if row["subject"] == "pictures")
    assert re.match(r"Blender \d+\.\d+\.\d+.* \(package bpy\) renders one", picture)


@pytest.mark.parametrize("check", [packages.python, machine.system, machine.memory, machine.text, stages.encoder])
def test_what_is_right_here(check):
    found = check()
    assert found.state is State.OK, found


def test_a_package_that_is_missing(monkeypatch):
    monkeypatch.setattr(packages, "requires", lambda name: ["packaging", "no-such-package>=1,<2"])
    found = {finding.subject: finding for finding in packages.packages()}
    assert found["no-such-package"].state is State.WRONG
    assert "pip install 'no-such-package<2,>=1'" in found["no-such-package"].fix
    assert found["packages"].text.startswith("1 of 2")


def test_a_package_of_another_version(monkeypatch):
    monkeypatch.setattr(packages, "requires", lambda name: ["packaging<1"])
    (found,) = packages.packages()
    assert found.state is State.WARNING and "was not tried; <1 was" in found.text


def test_what_another_python_or_extra_needs_does_not_count(monkeypatch):
    needed = ["packaging", "nothing; python_version < '3'", "nothing; extra == 'slurm'"]
    monkeypatch.setattr(packages, "requires", lambda name: needed)
    assert states(packages.packages()) == {"packages": State.OK}


def test_a_broken_wheel(monkeypatch, tmp_path):
    """A shared library that was not downloaded to its end."""
    whole = Path(find_spec("manifold3d").origin)
    (tmp_path / whole.name).write_bytes(whole.read_bytes()[:1000])
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setattr(packages, "requires", lambda name: ["manifold3d"])
    (found,) = packages.packages()
    assert found.state is State.WRONG
    assert "cannot be imported: " in found.text
    assert "--force-reinstall" in found.fix


@pytest.mark.skipif(shutil.which("cc") is None or shutil.which("ldd") is None, reason="needs a compiler and ldd")
def test_a_library_of_the_system_that_is_missing(monkeypatch, tmp_path):
    """All that a package's libraries link to are named at once, with the packages of Debian that have them."""
    for name in ("libusual.so.1", "libvery_rare.so.9"):
        subprocess.run(["cc", "-shared", "-o", tmp_path / name, f"-Wl,-soname,{name}", *EMPTY], check=True)
    package = tmp_path / "frail"
    package.mkdir()
    libraries = [tmp_path / "libusual.so.1", tmp_path / "libvery_rare.so.9"]
    binary = package / "binary.so"
    words = ["-Wl,--no-as-needed", *libraries]
    subprocess.run(["cc", "-shared", "-o", binary, *EMPTY, *words], check=True)
    for library in libraries:
        library.unlink()
    (package / "__init__.py").write_text(f"import ctypes\nctypes.CDLL({str(binary)!r})\n")
    information = tmp_path / "frail-1.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: frail\nVersion: 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setattr(packages, "requires", lambda name: ["frail"])
    monkeypatch.setattr(packages, "LIBRARIES", {"libusual": "libusual1"})
    (found,) = packages.packages()
    assert found.state is State.WRONG
    assert "apt-get install libusual1" in found.fix and "libvery_rare.so.9" in found.fix


def test_a_python_without_the_package_of_blender(monkeypatch):
    """As 3.12: an installed one is named, where there is one."""
    monkeypatch.delenv("TIDEMILL_BLENDER", raising=False)
    monkeypatch.setattr(stages, "find_spec", lambda name: None)
    monkeypatch.setattr(shutil, "which", lambda name: "/usr/bin/blender")
    found = stages.picture()
    assert found.state is State.WRONG and "3.11 and 3.13" in found.text
    assert found.fix.endswith("export TIDEMILL_BLENDER=/usr/bin/blender")


def test_a_blender_that_does_not_run_is_named(monkeypatch):
    monkeypatch.setenv("TIDEMILL_BLENDER", "/no/such/blender")
    found = stages.picture()
    assert found.state is State.WRONG and "(TIDEMILL_BLENDER=/no/such/blender) does not render" in found.text
    assert "unset it" in found.fix


def test_a_disk_on_which_nothing_can_be_written(tmp_path):
    """As a full one, or one on which nothing more is allowed."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))

    code = "from tidemill.doctor import machine\nfor found in machine.disks(): print(found)"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, cwd=tmp_path, env=environment, preexec_fn=limit, capture_output=True, text=True)
    lines = done.stdout.splitlines()
    assert len(lines) == 3 and all("State.WRONG" in line and "free some space, or" in line for line in lines), done


@pytest.mark.parametrize(("free", "state"), [(1e8, State.WRONG), (1e9, State.WARNING), (1e11, State.OK)])
def test_room_on_a_disk(monkeypatch, tmp_path, free, state):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: shutil._ntuple_diskusage(free, 0, free))
    assert set(states(machine.disks()).values()) == {state}


@pytest.mark.parametrize(("free", "state"), [(1e9, State.WRONG), (3e9, State.WARNING), (9e9, State.OK)])
def test_memory(monkeypatch, free, state):
    monkeypatch.setattr(machine, "_free_memory", lambda: free)
    assert machine.memory().state is state


def test_what_crashes_or_hangs_is_told(monkeypatch):
    assert "SIGSEGV" in attempt(["-c", "import ctypes; ctypes.string_at(0)"]).reason
    assert attempt(["-c", "raise SystemExit('no')"]).reason == "no"
    monkeypatch.setattr("tidemill.doctor.trial.LONGEST", 0.5)
    assert "within 0.5 s" in attempt(["-c", "import time; time.sleep(30)"]).reason


def test_a_check_that_fails_is_a_finding_itself(monkeypatch):
    def fails():
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(report, "CHECKS", {"disk": fails, "rest": lambda: ok("rest", "is right")})
    first, second = report.look()
    assert first == wrong("disk", "cannot be tried: No space left on device", "mend what is wrong above first")
    assert second.state is State.OK


def test_what_it_prints_and_returns(monkeypatch, capsys):
    monkeypatch.setattr(report, "CHECKS", {"rest": lambda: ok("rest", "is right")})
    assert report.main([], "tidemill doctor") == 0
    assert "films can be made" in capsys.readouterr().out
    monkeypatch.setattr(report, "CHECKS", {"fluid": lambda: wrong("fluid", "leaks", "mend it")})
    assert report.main([], "tidemill doctor") == 1
    said = capsys.readouterr().out
    assert "wrong    fluid" in said and "fix: mend it" in said and "1 wrong: fluid" in said
    assert report.main(["--json"], "tidemill doctor") == 1
    assert json.loads(capsys.readouterr().out)["findings"] == [
        {"subject": "fluid", "state": "wrong", "text": "leaks", "fix": "mend it"}
    ]
