"""Runs the command of one job so that its folder of results is there in full or not at all.

    python -m workflow.job --output DIR --failed DIR --log FILE --plan TEXT -- COMMAND ... @OUT ...

The command writes into the folder @OUT, beside DIR or on a disk of the machine (--scratch); when it
ends with 0 a manifest is added, all is written through to the disk, and the folder takes the name
DIR. Otherwise what there is moves to the folder of --failed, and the command's exit code is passed
on. One job at a time makes a result, and the command does not outlive the job, nor the job the
workflow that started it. What was refused or stopped for its settings is not tried again.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import errno
import fcntl
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

from common.command import end_with
from common.manifest import Manifest

PLACEHOLDER = "@OUT"
PR_SET_PDEATHSIG = 1
PATIENCE = 10.0
"""How long a command may take to end when asked to [s]."""
NEARLY_FULL = 4 * 1024 * 1024
"""Free space on the disk below which a failure is put down to it [bytes]."""
MEANINGS = {
    2: "refused its settings",
    3: "stopped the simulation",
}


class Interrupted(Exception):
    def __init__(self, signum: int):
        super().__init__(signal.Signals(signum).name)
        self.signum = signum


class Log:
    """What a job says, to the terminal and to its log file; it goes on where one of them cannot be written."""

    def __init__(self, file: Path):
        self._sinks: list[BinaryIO] = [sys.stderr.buffer]
        with contextlib.suppress(OSError):
            file.parent.mkdir(parents=True, exist_ok=True)
            self._sinks.append(file.open("wb"))

    def write(self, text: bytes) -> None:
        """Pass bytes on at once, also where one of the two fails."""
        for sink in self._sinks:
            with contextlib.suppress(OSError, ValueError):
                sink.write(text)
                sink.flush()

    def say(self, message: str) -> None:
        """Add a line of the pipeline's own."""
        self.write(f"tidemill: {message}\n".encode())


def run(
    command: Sequence[str],
    *,
    output: Path,
    failed: Path,
    log: Log,
    plan: str,
    attempt: int = 1,
    scratch: Path | None = None,
) -> int:
    """Run a command as described above; returns the exit code."""
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        with _only_one(output, log):
            _sweep(output)
            verdict = _verdict(failed, plan) if attempt > 1 else None
            if verdict is not None:
                log.say(f"{output}: the command {MEANINGS[verdict]} before: it is not tried again")
                return verdict
            partial = output.with_name(f"{_partial_prefix(output)}{os.getpid()}")
            partial.mkdir()
            try:
                with _workplace(partial, scratch) as folder:
                    code = _run_stage([part.replace(PLACEHOLDER, str(folder)) for part in command], log)
                if code == 0:
                    _publish(partial, output, plan)
                    shutil.rmtree(failed, ignore_errors=True)
                else:
                    _set_aside(partial, failed, code, log)
                _judge(failed, plan, code)
                return code
            finally:
                shutil.rmtree(partial, ignore_errors=True)
    except Interrupted as interrupted:
        log.say(f"{output}: stopped by {interrupted}; nothing of it is kept")
        return 128 + interrupted.signum
    except OSError as error:
        log.say(_explain(error, output))
        return 1


@contextlib.contextmanager
def _workplace(partial: Path, scratch: Path | None) -> Iterator[Path]:
    """The folder that the command writes into. In a scratch folder, it is moved to `partial` at once at the end, so
    that a file system which many nodes share sees each file once."""
    if scratch is None:
        yield partial
        return
    scratch.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=scratch, prefix="tidemill-") as folder:
        yield Path(folder)
        shutil.copytree(folder, partial, dirs_exist_ok=True)


def _verdict_file(failed: Path) -> Path:
    return failed.with_name(f"{failed.name}.verdict")


def _judge(failed: Path, plan: str, code: int) -> None:
    """Note for which plan a command ended in a way that another attempt would not change."""
    _verdict_file(failed).unlink(missing_ok=True)
    if code in MEANINGS:
        failed.parent.mkdir(parents=True, exist_ok=True)
        _verdict_file(failed).write_text(f"{code} {plan}\n")


def _verdict(failed: Path, plan: str) -> int | None:
    """The exit code of an earlier attempt at the same, where it says that another would end the same way."""
    try:
        code, _, judged = _verdict_file(failed).read_text().strip().partition(" ")
    except OSError:
        return None
    return int(code) if judged == plan and code.isdecimal() and int(code) in MEANINGS else None


def _run_stage(command: Sequence[str], log: Log) -> int:
    end_with_parent = _at_death_of_parent(signal.SIGKILL)
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        process_group=0,
        preexec_fn=end_with_parent,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    ) as stage:
        try:
            while stage.stdout and (chunk := os.read(stage.stdout.fileno(), 65536)):
                log.write(chunk)
            code = stage.wait()
        except BaseException:
            _end(stage)
            raise
    return code if code >= 0 else 128 - code


def _end(stage: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(stage.pid, signal.SIGTERM)
        try:
            stage.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(stage.pid, signal.SIGKILL)


def _publish(partial: Path, output: Path, plan: str) -> None:
    Manifest.of(partial, plan).write(partial)
    for folder, _, files in os.walk(partial):
        for name in (*files, "."):
            _write_through(os.path.join(folder, name))
    if output.exists():
        shutil.rmtree(output)
    partial.rename(output)
    _write_through(output.parent)


def _write_through(path: str | Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _set_aside(partial: Path, failed: Path, code: int, log: Log) -> None:
    what = MEANINGS.get(code, f"was killed by signal {code - 128}" if code > 128 else f"failed with exit code {code}")
    message = f"the command {what}"
    if shutil.disk_usage(partial).free < NEARLY_FULL:
        message += f"; the disk of {partial.parent} is full: free some space and run the same command again"
    elif any(partial.iterdir()):
        shutil.rmtree(failed, ignore_errors=True)
        failed.parent.mkdir(parents=True, exist_ok=True)
        try:
            shutil.move(partial, failed)
            message += f"; what it left is in {failed}"
        except OSError as error:
            message += f"; what it left could not be kept: {_explain(error, failed)}"
    log.say(message)


@contextlib.contextmanager
def _only_one(output: Path, log: Log) -> Iterator[None]:
    """Hold the lock of a result; waits for whoever holds it."""
    path = output.with_name(f".{output.name}.lock")
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            log.say(f"another process still works on {output}: waiting for its end")
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        if path.exists() and os.path.samestat(os.fstat(descriptor), path.stat()):
            break
        os.close(descriptor)
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
        os.close(descriptor)


def _partial_prefix(output: Path) -> str:
    return f".{output.name}.partial-"


def _sweep(output: Path) -> None:
    """Remove what killed predecessors left; only for the holder of the lock."""
    for path in output.parent.iterdir():
        if path.name.startswith(_partial_prefix(output)):
            shutil.rmtree(path)


def _explain(error: OSError, output: Path) -> str:
    reasons = {
        errno.ENOSPC: "the disk is full: free some space and run the same command again",
        errno.EDQUOT: "the disk quota is used up: free some space and run the same command again",
        errno.EROFS: "the file system is read-only: work in a folder that can be written",
        errno.EACCES: "there is no permission to write here: change the owner or the mode of the folder",
        errno.EPERM: "there is no permission to write here: change the owner or the mode of the folder",
    }
    where = error.filename or output
    return f"{where}: cannot be written: {reasons.get(error.errno or 0, error.strerror or str(error))}"


def _at_death_of_parent(signum: int) -> Callable[[], None]:
    """A function that makes the calling process receive a signal when its parent ends; without effect elsewhere
    than on Linux."""
    if sys.platform != "linux":
        return lambda: None
    libc = ctypes.CDLL(None, use_errno=True)
    return lambda: libc.prctl(PR_SET_PDEATHSIG, signum)


def _interrupt(signum: int, _frame: object) -> None:
    signal.signal(signum, signal.SIG_IGN)
    raise Interrupted(signum)


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.job",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--output", type=Path, required=True, help="folder that the job makes")
    parser.add_argument("--failed", type=Path, required=True, help="where what is left of a failed job goes")
    parser.add_argument("--log", type=Path, required=True, help="file for all that the command prints")
    parser.add_argument("--plan", required=True, help="what the result was made for: kept in its manifest")
    parser.add_argument("--attempt", type=int, default=1, metavar="N", help="which attempt in one call of snakemake")
    parser.add_argument(
        "--scratch",
        default="",
        metavar="DIR",
        help="write into this folder first, or into the one that this variable of the machine names, as TMPDIR",
    )
    parser.add_argument("command", nargs=argparse.REMAINDER, help="-- and the command, with @OUT for its folder")
    arguments = parser.parse_args(argv)
    command = arguments.command[1:] if arguments.command[:1] == ["--"] else arguments.command
    if not command:
        parser.error("there is no command after --")
    _at_death_of_parent(signal.SIGTERM)()
    for signum in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(signum, _interrupt)
    return run(
        command,
        output=arguments.output,
        failed=arguments.failed,
        log=Log(arguments.log),
        plan=arguments.plan,
        attempt=arguments.attempt,
        scratch=_scratch(arguments.scratch),
    )


def _scratch(text: str) -> Path | None:
    """A folder, or what a variable of the node names; none where it is not set there."""
    path = text if text.startswith("/") else os.environ.get(text, "")
    return Path(path) if path else None


if __name__ == "__main__":
    end_with(main, goes_on=True)
