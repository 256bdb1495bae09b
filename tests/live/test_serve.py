"""`python -m sim live` as a process."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from live.listening import TRIED, free_port
from scene.settings import Refused
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


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--host", "192.0.2.1"], "--host 192.0.2.1 is no address at which this machine can listen"),
        (["--host", "no.such.machine.invalid"], "--host no.such.machine.invalid is no address"),
        (["--host", "."], "--host . is no"),
        (["--port", "65536"], "--port 65536 is no port"),
        (["--port", "-1"], "--port -1 is no port"),
    ],
)
def test_where_it_cannot_listen_it_says_so(scene, options, message):
    """The server of the page waited for ever."""
    command = [sys.executable, "-m", "sim", "live", str(scene), *options]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and message in done.stderr and "fix: " in done.stderr


def test_the_next_free_port_is_taken():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert port < free_port("127.0.0.1", port) < port + TRIED


def test_no_free_port_is_refused(monkeypatch):
    monkeypatch.setattr("live.listening.TRIED", 1)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(Refused, match="no port from"):
            free_port("127.0.0.1", taken.getsockname()[1])


def test_a_scene_that_can_not_run_is_refused(scene):
    scene.write_text(SCENE.replace("300", "-300"))
    command = [sys.executable, "-m", "sim", "live", str(scene)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and "density" in done.stderr
