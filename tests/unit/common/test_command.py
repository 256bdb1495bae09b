"""Commands end quietly when whoever reads what they print has gone, and what they make is made all the same."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
SCENE = ROOT / "scenes" / "tiny" / "still.yaml"
PRINTS = """
import sys
from common.command import end_with

def main():
    for number in range(100_000):
        print("line", number)
    return 0

end_with(main)
"""
MAKES = """
import sys
from pathlib import Path
from common.command import end_with

def main():
    for number in range(100_000):
        print("line", number)
        print("line", number, file=sys.stderr)
    Path(sys.argv[1]).write_text("made")
    return int(sys.argv[2])

end_with(main, goes_on=True)
"""


def run(arguments, *, stdout=subprocess.PIPE, buffered=True, **options):
    """A command of Python from the root of the project; the messages that it leaves on its standard error."""
    environment = {**os.environ, "PYTHONUNBUFFERED": "" if buffered else "1"}
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=ROOT,
        env=environment,
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        timeout=60,
        **options,
    )


@pytest.fixture
def nobody():
    """The end to write of a pipe that nobody reads."""
    read, write = os.pipe()
    os.close(read)
    yield write
    os.close(write)


@pytest.mark.parametrize("buffered", [True, False])
@pytest.mark.parametrize("arguments", [["-c", PRINTS], ["-m", "sim", "check", SCENE], ["-m", "sim", "explain", SCENE]])
def test_what_only_prints_ends_quietly(nobody, arguments, buffered):
    done = run(arguments, stdout=nobody, buffered=buffered)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.parametrize("module", ["workflow.catalog", "workflow.status"])
def test_commands_of_the_workflow_too(nobody, module):
    done = run(["-m", module, *(["tiny/still"] if module == "workflow.status" else [])], stdout=nobody)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.parametrize("status", [0, 3])
def test_what_makes_files_goes_on(nobody, tmp_path, status):
    done = subprocess.run([sys.executable, "-c", MAKES, tmp_path / "file", str(status)], stdout=nobody, stderr=nobody)
    assert done.returncode == status
    assert (tmp_path / "file").read_text() == "made"


def test_a_run_is_not_lost_with_the_reader_of_its_progress(nobody, tmp_path):
    command = [sys.executable, "-m", "sim", "run", SCENE, "--frames", "0:1", "--out", tmp_path / "out"]
    done = subprocess.run(command, cwd=ROOT, stdout=nobody, stderr=nobody, timeout=120)
    assert done.returncode == 0
    assert (tmp_path / "out" / "summary.json").exists()


def test_closed_streams_are_no_files(tmp_path):
    """The first files that are opened would take the numbers of the streams, and hold what is printed."""
    script = "import os, sys; os.closerange(0, 3); os.execv(sys.argv[1], sys.argv[1:])"
    run(["-c", script, sys.executable, "-c", MAKES, tmp_path / "file", "0"])
    assert (tmp_path / "file").read_text() == "made"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("buffered", [True, False])
def test_a_full_disk_is_told(buffered):
    with open("/dev/full", "w") as full:
        done = run(["-c", PRINTS], stdout=full, buffered=buffered)
    assert done.returncode == 1
    assert done.stderr == "what was to be written cannot be: No space left on device\n"


def test_no_traceback_at_an_interrupt():
    script = "from common.command import end_with\ndef main(): raise KeyboardInterrupt\nend_with(main)"
    done = run(["-c", script])
    assert (done.returncode, done.stderr) == (130, "")
