"""`python -m sim live` as a process."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.live.stage import SCENE
from tests.live.viewer import Viewer

ROOT = Path(__file__).parents[2]


@contextmanager
def serving(scene: Path, *options: str) -> Iterator[tuple[subprocess.Popen, int, str]]:
    """The process, its port, and what it has said until the page was open."""
    command = [sys.executable, "-m", "sim", "live", str(scene), "--port", "0", "--threads", "1", *options]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    said = ""
    try:
        for line in process.stderr:
            said += line
            found = re.search(r"live: http://\S+:(\d+)", line)
            if found:
                yield process, int(found.group(1)), said
                break
        else:
            raise AssertionError(said)
    finally:
        process.kill()
        process.communicate()


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "pool.yaml"
    path.write_text(SCENE.replace("10 mm", "20 mm"))
    return path


def test_it_serves_until_it_is_interrupted(scene):
    with serving(scene) as (process, port, _):
        viewer = Viewer(port)
        viewer.press("Next frame")
        end = time.monotonic() + 60
        while viewer.pictures < 2:
            assert time.monotonic() < end
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        assert process.wait(30) == 0


def test_another_address_needs_a_token(scene):
    with serving(scene, "--host", "0.0.0.0") as (_, port, said):
        token = re.search(r"token: (\S+)", said).group(1)
        assert "warning: everybody who reaches 0.0.0.0" in said
        viewer = Viewer(port)
        viewer.set("token", token)
        viewer.press("Enter")
        viewer.wait_for("Play")


def test_a_scene_that_can_not_run_is_refused(scene):
    scene.write_text(SCENE.replace("300", "-300"))
    command = [sys.executable, "-m", "sim", "live", str(scene)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and "density" in done.stderr
