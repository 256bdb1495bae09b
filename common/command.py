"""How the commands of this project begin and end: with all streams open, and quietly when their reader has gone."""

from __future__ import annotations

import errno
import io
import os
import re
import signal
import sys
from collections.abc import Callable
from typing import Any, NoReturn, TextIO

from common.signals import INTERRUPTED

FAILED = 1
READER_GONE = 128 + signal.SIGPIPE
"""What a shell tells of a command that ended of it."""
FULL = (errno.ENOSPC, errno.EDQUOT)


def as_called(text: str | None, called: str) -> str:
    """A text of help in which commands are called as this one was: as modules, or by `tidemill`."""
    text = text or ""
    return re.sub(r"python -m (?:sim |workflow\.)", "tidemill ", text) if called.startswith("tidemill") else text


def end_with(main: Callable[[], int | None], *, goes_on: bool = False) -> NoReturn:
    """End the process with what `main` returns, or with READER_GONE once nobody reads what it prints.

    `goes_on`: `main` makes files, and makes them unheard; see `go_on_unheard`.
    """
    _open_streams()
    if goes_on:
        go_on_unheard()
    sys.exit(_status(main))


def go_on_unheard() -> None:
    """From now on nothing is lost but words where what this process prints cannot be written any more.

    Streams that were put in place of its own stay as they are.
    """
    for name in ("stdout", "stderr"):
        own = getattr(sys, f"__{name}__")
        if getattr(sys, name) is own:
            _put(name, _unheard(own))


def _put(name: str, stream: TextIO) -> None:
    """In place of `stdout` or `stderr`, and of what Python keeps of it."""
    setattr(sys, name, stream)
    setattr(sys, f"__{name}__", stream)


class _Unheard(io.FileIO):
    """Takes whatever is written, and drops what cannot be."""

    def write(self, data: Any) -> int:
        try:
            return super().write(data)
        except OSError:
            return memoryview(data).nbytes


def _unheard(stream: io.TextIOWrapper) -> TextIO:
    stream.flush()
    raw = _Unheard(stream.fileno(), "w", closefd=False)
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        encoding=stream.encoding,
        errors="backslashreplace",
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )


def _status(main: Callable[[], int | None]) -> int | str | None:
    try:
        status: int | str | None
        try:
            status = main()
        except SystemExit as ending:
            status = ending.code
        except KeyboardInterrupt:
            status = INTERRUPTED
        sys.stdout.flush()
        sys.stderr.flush()
        return status
    except BrokenPipeError:
        _drop(sys.stdout, sys.stderr)
        return READER_GONE
    except OSError as error:
        if error.errno not in FULL:
            raise
        print(f"what was to be written cannot be: {error.strerror}", file=sys.stderr)
        _drop(sys.stdout)
        return FAILED


def _drop(*streams: TextIO) -> None:
    """Send what is still in the buffers nowhere, or Python complains of it when it ends."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in streams:
        os.dup2(nowhere, stream.fileno())


def _open_streams() -> None:
    """Where one of the three streams was closed, the next file that is opened would take its place."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    if sys.stdout is None:
        _put("stdout", os.fdopen(1, "w", closefd=False, encoding="utf-8"))
    if sys.stderr is None:
        _put("stderr", os.fdopen(2, "w", closefd=False, encoding="utf-8"))
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
