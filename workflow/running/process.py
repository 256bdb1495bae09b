"""A command as a child of this process: what it prints goes on to the log, and neither outlives the other."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import BinaryIO

PR_SET_PDEATHSIG = 1
PATIENCE = 10.0
"""How long a command may take to end when asked to [s]."""


class Interrupted(Exception):
    """A signal asked this process to end."""

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


def run(command: Sequence[str], log: Log) -> int:
    """Run a command to its end; returns its exit code, 128 + the signal where one ended it."""
    end_with_parent = at_death_of_parent(signal.SIGKILL)
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


def at_death_of_parent(signum: int) -> Callable[[], None]:
    """A function that makes the calling process receive a signal when its parent ends; without effect elsewhere
    than on Linux."""
    if sys.platform != "linux":
        return lambda: None
    libc = ctypes.CDLL(None, use_errno=True)
    return lambda: libc.prctl(PR_SET_PDEATHSIG, signum)


def interrupt(signum: int, _frame: object) -> None:
    """The handler of signals that ask to end: raises Interrupted, once."""
    signal.signal(signum, signal.SIG_IGN)
    raise Interrupted(signum)
