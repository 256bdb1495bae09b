"""A job's result is there in full or not at all, whatever happens to the job."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
import zlib
from pathlib import Path

import pytest

from common.manifest import Manifest, damage

ROOT = Path(__file__).resolve().parents[3]


def arguments(folder: Path, *command: str, name: str = "made") -> list[str]:
    return [
        *(sys.executable, "-m", "workflow.job", "--output", str(folder / name), "--failed", str(folder / "failed")),
        *("--log", str(folder / "logs" / f"{name}.log"), "--plan", "plan 1", "--", *command),
    ]


def python(code: str) -> tuple[str, ...]:
    return (sys.executable, "-c", code, "@OUT")


WRITE = "import sys, pathlib; out = pathlib.Path(sys.argv[1]); (out / 'a.txt').write_text('abc'); print('hello')"


def run(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(arguments(folder, *command), cwd=ROOT, capture_output=True, text=True, timeout=60)


def hidden(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob(".*")]


def wait_for(condition, seconds: float = 10.0) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return False


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_success(tmp_path):
    done = run(tmp_path, *python(WRITE))
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "made" / "a.txt").read_text() == "abc"
    made = Manifest.read(tmp_path / "made")
    assert (made.plan, made.files, made.sums) == ("plan 1", {"a.txt": 3}, {"a.txt": zlib.crc32(b"abc")})
    assert damage(tmp_path / "made") == ""
    assert "hello" in (tmp_path / "logs" / "made.log").read_text()
    assert "hello" in done.stderr
    assert not hidden(tmp_path)


def test_an_earlier_result_is_replaced_as_a_whole(tmp_path):
    (tmp_path / "made").mkdir()
    (tmp_path / "made" / "old.txt").touch()
    assert run(tmp_path, *python(WRITE)).returncode == 0
    assert sorted(path.name for path in (tmp_path / "made").iterdir()) == ["a.txt", "manifest.json"]


@pytest.mark.parametrize(("code", "words"), [(2, "refused"), (3, "stopped the simulation"), (7, "exit code 7")])
def test_failure_keeps_what_is_left_apart_and_passes_the_code_on(tmp_path, code, words):
    (tmp_path / "failed").mkdir()
    (tmp_path / "failed" / "older.txt").touch()
    write = f"import sys, pathlib; (pathlib.Path(sys.argv[1]) / 'failure.json').write_text('why'); sys.exit({code})"
    done = run(tmp_path, *python(write))
    assert done.returncode == code
    assert not (tmp_path / "made").exists()
    assert [path.name for path in (tmp_path / "failed").iterdir()] == ["failure.json"]
    for text in (done.stderr, (tmp_path / "logs" / "made.log").read_text()):
        assert words in text
        assert str(tmp_path / "failed") in text
    assert not hidden(tmp_path)


def test_a_later_success_removes_what_a_failure_left(tmp_path):
    (tmp_path / "failed").mkdir()
    assert run(tmp_path, *python(WRITE)).returncode == 0
    assert not (tmp_path / "failed").exists()


def test_a_command_that_is_killed(tmp_path):
    done = run(tmp_path, *python("import os, signal; os.kill(os.getpid(), signal.SIGKILL)"))
    assert done.returncode == 128 + signal.SIGKILL
    assert "signal 9" in done.stderr


def test_a_command_that_does_not_exist(tmp_path):
    done = run(tmp_path, "/no/such/command")
    assert done.returncode == 1
    assert "/no/such/command" in done.stderr
    assert "Traceback" not in done.stderr


SLEEP = """
import os, pathlib, sys, time
out = pathlib.Path(sys.argv[1])
(out / 'half.txt').write_text('h')
(out.parent / 'stage.pid').write_text(str(os.getpid()))
time.sleep(60)
"""
PARENT = """
import pathlib, subprocess, sys
child = subprocess.Popen(sys.argv[1:])
print(child.pid, flush=True)
child.wait()
"""


def started(folder: Path) -> int:
    assert wait_for(lambda: (folder / "stage.pid").exists() and (folder / "stage.pid").read_text())
    return int((folder / "stage.pid").read_text())


@pytest.mark.skipif(sys.platform != "linux", reason="the signal at the parent's end is Linux's own")
def test_nothing_outlives_the_workflow(tmp_path):
    parent = subprocess.Popen(
        [sys.executable, "-c", PARENT, *arguments(tmp_path, *python(SLEEP))],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )
    runner = int(parent.stdout.readline())
    stage = started(tmp_path)
    parent.kill()
    parent.wait()
    assert wait_for(lambda: not alive(runner) and not alive(stage))
    assert not (tmp_path / "made").exists()
    assert not hidden(tmp_path)


@pytest.mark.skipif(sys.platform != "linux", reason="the signal at the parent's end is Linux's own")
def test_the_command_does_not_outlive_its_killed_job_and_the_next_job_cleans_up(tmp_path):
    runner = subprocess.Popen(arguments(tmp_path, *python(SLEEP)), cwd=ROOT, stderr=subprocess.DEVNULL)
    stage = started(tmp_path)
    runner.kill()
    runner.wait()
    assert wait_for(lambda: not alive(stage))
    assert any("partial" in name for name in hidden(tmp_path))
    assert run(tmp_path, *python(WRITE)).returncode == 0
    assert not hidden(tmp_path)
    assert not (tmp_path / "made" / "half.txt").exists()


@pytest.mark.parametrize("signum", [signal.SIGINT, signal.SIGTERM])
def test_a_polite_end(tmp_path, signum):
    runner = subprocess.Popen(arguments(tmp_path, *python(SLEEP)), cwd=ROOT, stderr=subprocess.PIPE, text=True)
    stage = started(tmp_path)
    runner.send_signal(signum)
    _, said = runner.communicate(timeout=20)
    assert runner.returncode == 128 + signum
    assert signal.Signals(signum).name in said
    assert not alive(stage)
    assert not (tmp_path / "made").exists()
    assert not hidden(tmp_path)


def test_two_jobs_for_one_result_take_turns(tmp_path):
    code = (
        "import sys, time, pathlib; begin = time.monotonic(); time.sleep(1); "
        "(pathlib.Path(sys.argv[1]).parent / f'{begin}.time').write_text(str(time.monotonic()))"
    )
    jobs = [subprocess.Popen(arguments(tmp_path, *python(code)), cwd=ROOT, stderr=subprocess.DEVNULL) for _ in "ab"]
    assert [job.wait(30) for job in jobs] == [0, 0]
    spans = sorted((float(path.stem), float(path.read_text())) for path in tmp_path.glob("*.time"))
    assert len(spans) == 2
    assert spans[0][1] <= spans[1][0]


@contextlib.contextmanager
def mounted(folder: Path, options: str):
    folder.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)], capture_output=True)
    if done.returncode:
        pytest.skip("mounting is not possible here")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)


FILL = "import sys, pathlib; (pathlib.Path(sys.argv[1]) / 'big').write_bytes(bytes(2_000_000))"


@pytest.mark.skipif(os.geteuid() != 0, reason="mounting needs root")
def test_a_full_disk(tmp_path):
    with mounted(tmp_path / "disk", "size=512k") as disk:
        done = run(disk, *python(FILL))
        assert done.returncode != 0
        assert "tidemill:" in done.stderr
        assert "is full" in done.stderr
        assert not (disk / "made").exists()
        assert not (disk / "failed").exists()


@pytest.mark.skipif(os.geteuid() != 0, reason="mounting needs root")
def test_a_disk_that_is_full_for_the_manifest(tmp_path):
    with mounted(tmp_path / "disk", "size=512k") as disk:
        free = os.statvfs(disk).f_bavail * 4096 - 3 * 4096
        fill = f"import sys, pathlib; (pathlib.Path(sys.argv[1]) / 'big').write_bytes(bytes({free}))"
        done = run(disk, *python(fill + "; import os; os.system('cat /dev/zero > ' + sys.argv[1] + '/rest')"))
        assert done.returncode == 1
        assert "the disk is full" in done.stderr
        assert "Traceback" not in done.stderr
        assert not (disk / "made").exists()


@pytest.mark.skipif(os.geteuid() != 0, reason="mounting needs root")
def test_a_read_only_folder(tmp_path):
    with mounted(tmp_path / "disk", "ro") as disk:
        done = run(disk, *python(WRITE))
        assert done.returncode == 1
        assert "read-only" in done.stderr
        assert "Traceback" not in done.stderr


@pytest.mark.skipif(os.geteuid() == 0, reason="root ignores permissions")
def test_a_folder_without_permission(tmp_path):
    tmp_path.chmod(0o555)
    try:
        done = run(tmp_path, *python(WRITE))
    finally:
        tmp_path.chmod(0o755)
    assert done.returncode == 1
    assert "permission" in done.stderr


@pytest.mark.parametrize(("code", "again"), [(2, False), (3, False), (7, True)])
def test_what_was_refused_or_stopped_is_not_tried_again(tmp_path, code, again):
    count = tmp_path / "count"
    command = python(f"import sys; open({str(count)!r}, 'a').write('x'); sys.exit({code})")
    options = arguments(tmp_path, *command)
    for attempt in ("1", "2"):
        extended = [*options[:3], "--attempt", attempt, *options[3:]]
        done = subprocess.run(extended, cwd=ROOT, capture_output=True, text=True, timeout=60)
        assert done.returncode == code
    assert len(count.read_text()) == (2 if again else 1)
    assert ("not tried again" in done.stderr) is not again


def test_another_plan_and_another_call_are_tried(tmp_path):
    count = tmp_path / "count"
    options = arguments(tmp_path, *python(f"import sys; open({str(count)!r}, 'a').write('x'); sys.exit(2)"))
    other = [part.replace("plan 1", "plan 2") for part in options]
    for command in (options, options, [*other[:3], "--attempt", "2", *other[3:]]):
        subprocess.run(command, cwd=ROOT, capture_output=True, timeout=60)
    assert count.read_text() == "xxx"


@pytest.mark.parametrize("named", ["folder", "variable", "unset"])
def test_scratch_is_written_first_and_left_empty(tmp_path, named):
    scratch, seen = tmp_path / "scratch", tmp_path / "seen"
    code = f"import sys; open({str(seen)!r}, 'w').write(sys.argv[1]); {WRITE}"
    options = arguments(tmp_path, *python(code))
    value = str(scratch) if named == "folder" else "NODES_DISK"
    environment = {**os.environ, **({"NODES_DISK": str(scratch)} if named == "variable" else {})}
    command = [*options[:3], f"--scratch={value}", *options[3:]]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, env=environment)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "made" / "a.txt").read_text() == "abc" and damage(tmp_path / "made") == ""
    assert (scratch in Path(seen.read_text()).parents) is (named != "unset")
    assert not hidden(tmp_path) and not (scratch.exists() and list(scratch.iterdir()))
