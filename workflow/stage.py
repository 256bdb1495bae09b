"""What the commands of the stages share: whole files or none, times, exit codes."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import sys
import time
from collections.abc import Callable, Container, Iterable, Iterator
from pathlib import Path
from typing import Any

from common.manifest import spoiled
from scene.settings import Refused
from workflow.timeline import Frames

REFUSED = 2
FAILED = 1


def refuse_spoiled(folders: Iterable[Path], *kinds: str, frames: Container[int] | None = None) -> None:
    """Refuse files of earlier stages that are no longer what they were made as; see `common.manifest.spoiled`."""
    for folder in folders:
        path = spoiled(folder, kinds, frames)
        if path is not None:
            raise Refused(
                f"{path} no longer holds what was written to it",
                remedy=f"delete the folder {folder} and run the same command again: what is in it is made anew",
            )


def frames(text: str) -> Frames:
    """The value of an option --frames A:B."""
    try:
        return Frames.parse(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def write_whole(path: Path, write: Callable[[Path], None]) -> None:
    """Let `write` make a file beside `path`, if it has one to make; it gets the name only when it is complete."""
    partial = path.with_name(f".partial-{os.getpid()}-{path.name}")
    try:
        write(partial)
        if partial.exists():
            partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def write_json(path: Path, data: Any) -> None:
    text = json.dumps(data, indent=2, allow_nan=False) + "\n"
    write_whole(path, lambda partial: partial.write_text(text, encoding="utf-8"))


class Stopwatch:
    """Seconds of wall time by phase."""

    def __init__(self) -> None:
        self._start = time.perf_counter()
        self.seconds: dict[str, float] = {}

    @contextlib.contextmanager
    def phase(self, name: str) -> Iterator[None]:
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start

    def report(self) -> dict[str, float]:
        """Seconds by phase, and the total since the start."""
        phases = {**self.seconds, "total": time.perf_counter() - self._start}
        return {name: round(seconds, 4) for name, seconds in phases.items()}


def exit_code(run: Callable[[], None], name: str) -> int:
    """Run a stage: 0 done, 1 failed, 2 refused; says why in one message instead of a traceback."""
    try:
        run()
    except Refused as refused:
        print(f"{name}: {refused}", file=sys.stderr)
        return REFUSED
    except OSError as error:
        print(f"{name}: {error.filename or 'the output'}: {error.strerror or error}", file=sys.stderr)
        return FAILED
    return 0
