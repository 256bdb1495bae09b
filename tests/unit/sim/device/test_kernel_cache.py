"""Compiled kernels have a place, whatever the user's folders are: Taichi aborts, or crashes at its end, without one."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from scene.settings import Refused
from sim.device import kernel_cache
from sim.device.compiler_choice import COMPILERS

ROOT = Path(__file__).resolve().parents[4]
SCRIPT = """
import sim
import numpy as np
from sim.device.compiler import ti

from sim.device import runtime

runtime.start(threads=1, arch="cpu")

@ti.kernel
def total(numbers: ti.types.ndarray(dtype=ti.f32, ndim=1)) -> ti.f32:
    found = 0.0
    for i in range(8):
        found += numbers[i]
    return found

print(total(np.arange(8, dtype=np.float32)))
"""


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """Where nothing can be made in the usual folder; temporary files are in `tmp_path`."""
    monkeypatch.setenv("TI_OFFLINE_CACHE_FILE_PATH", "/proc/kernels")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tmp_path


def test_the_usual_folder(tmp_path, monkeypatch):
    monkeypatch.setattr("sim.device.compiler.compiler", COMPILERS["taichi"])
    monkeypatch.setenv("TI_OFFLINE_CACHE_FILE_PATH", str(tmp_path / "a" / "b"))
    assert kernel_cache.folder() == str(tmp_path / "a" / "b")


def test_a_folder_among_temporary_files(elsewhere):
    found = kernel_cache.folder()
    assert Path(found).parent == elsewhere
    assert os.stat(found).st_mode & 0o077 == 0
    assert kernel_cache.folder() == found


def test_no_folder_that_others_can_write_to(elsewhere):
    """Whoever could put kernels there would have them run."""
    planted = Path(kernel_cache.folder())
    planted.chmod(0o777)
    assert kernel_cache.folder() != str(planted)
    planted.rmdir()
    planted.symlink_to(elsewhere)
    assert kernel_cache.folder() != str(planted)


def test_no_folder_at_all_is_refused(elsewhere, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", "/proc")
    with pytest.raises(Refused, match="neither in /proc/kernels") as refused:
        kernel_cache.folder()
    assert "XDG_CACHE_HOME" in refused.value.remedy


@pytest.mark.parametrize("home", [None, "/proc", ""])
def test_a_process_without_a_home_ends_well(tmp_path, home):
    environment = {**os.environ, "TMPDIR": str(tmp_path), "HOME": home or "", "PYTHONPATH": str(ROOT)}
    for name in ("XDG_CACHE_HOME", "TI_OFFLINE_CACHE_FILE_PATH", *(["HOME"] if home is None else [])):
        environment.pop(name, None)
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    done = subprocess.run([sys.executable, script], env=environment, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "28.0\n"), done.stderr
