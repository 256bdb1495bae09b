"""Files that are whole or not there."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any, BinaryIO


@contextlib.contextmanager
def whole(path: Path) -> Iterator[BinaryIO]:
    """Write to a name beside `path` and rename at the end: no half file ever bears the name."""
    partial = path.with_name(f".{path.name}.partial")
    try:
        with open(partial, "wb") as stream:
            yield stream
        os.replace(partial, path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` make a file beside `path`, if it has one to make; it gets the name only when it is complete."""
    partial = path.with_name(f".partial-{os.getpid()}-{path.name}")
    try:
        write(partial)
        if partial.exists():
            partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def write_json(path: Path, data: Any) -> None:
    """Raises ValueError for numbers that are not finite, before anything is written, and OSError."""
    with whole(path) as stream:
        stream.write(json.dumps(data, indent=2, allow_nan=False).encode() + b"\n")


class Reserve:
    """Room on the disk, by a file without a name, for what has to be written even when the disk is full."""

    def __init__(self, folder: Path):
        self._folder = folder
        self._file: IO[bytes] | None = None
        self._size = 0

    def hold(self, size: int) -> None:
        """Keep `size` bytes free; raises OSError where there are not so many."""
        if size <= self._size:
            return
        if self._file is None:
            self._file = tempfile.TemporaryFile(dir=self._folder, buffering=0)  # noqa: SIM115
        left = memoryview(bytes(size - self._size))
        while left:
            left = left[self._file.write(left) :]
        self._size = size

    def release(self) -> None:
        """Give the room back."""
        if self._file is not None:
            self._file.close()
        self._file, self._size = None, 0
