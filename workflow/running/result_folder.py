"""The folder of a result while it is made: hidden until it is whole, by one job at a time; or set aside."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from common.manifest import Manifest
from workflow.running.process import Log
from workflow.running.verdict import MEANINGS

NEARLY_FULL = 4 * 1024 * 1024
"""Free space on the disk below which a failure is put down to it [bytes]."""


@contextlib.contextmanager
def workplace(partial: Path, scratch: Path | None) -> Iterator[Path]:
    """The folder that the command writes into. In a scratch folder, it is moved to `partial` at once at the end, so
    that a file system which many nodes share sees each file once."""
    if scratch is None:
        yield partial
        return
    scratch.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=scratch, prefix="tidemill-") as folder:
        yield Path(folder)
        shutil.copytree(folder, partial, dirs_exist_ok=True)


def publish(partial: Path, output: Path, plan: str) -> None:
    """Add the manifest, write all through to the disk, and let the folder take the name of the result."""
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


def set_aside(partial: Path, failed: Path, code: int, log: Log) -> None:
    """Move what a command left that ended with `code` to the folder of what failed, and tell of it."""
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
            message += f"; what it left could not be kept: {explain(error, failed)}"
    log.say(message)


@contextlib.contextmanager
def only_one(output: Path, log: Log) -> Iterator[None]:
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


def partial_folder(output: Path) -> Path:
    """Where this process makes a result, until it is whole."""
    return output.with_name(f"{_partial_prefix(output)}{os.getpid()}")


def _partial_prefix(output: Path) -> str:
    return f".{output.name}.partial-"


def sweep(output: Path) -> None:
    """Remove what killed predecessors left; only for the holder of the lock."""
    for path in output.parent.iterdir():
        if path.name.startswith(_partial_prefix(output)):
            shutil.rmtree(path)


def explain(error: OSError, output: Path) -> str:
    """What cannot be written, why, and what would help."""
    reasons = {
        errno.ENOSPC: "the disk is full: free some space and run the same command again",
        errno.EDQUOT: "the disk quota is used up: free some space and run the same command again",
        errno.EROFS: "the file system is read-only: work in a folder that can be written",
        errno.EACCES: "there is no permission to write here: change the owner or the mode of the folder",
        errno.EPERM: "there is no permission to write here: change the owner or the mode of the folder",
    }
    where = error.filename or output
    return f"{where}: cannot be written: {reasons.get(error.errno or 0, error.strerror or str(error))}"
