"""The one place that imports bpy, and what keeps it from talking and from hanging."""

from __future__ import annotations

import contextlib
import os
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from render.errors import RenderError, Unusable
from render.libraries import DEBIAN_PACKAGES
from render.program import VARIABLE


def import_remedy(error: ImportError) -> str:
    """Why bpy could not be imported, and what to install."""
    if isinstance(error, ModuleNotFoundError):
        return (
            "Blender is missing: install the Python package bpy, which there is for Python 3.11 and 3.13, "
            f"or name an installed Blender: export {VARIABLE}=PATH"
        )
    missing = re.search(r"(lib\w+)[\w.+-]*\.so[.\d]*: cannot open shared object file", str(error))
    package = DEBIAN_PACKAGES.get(missing[1]) if missing else None
    if missing is None or package is None:
        return f"Blender cannot be loaded: {error}"
    others = " ".join(sorted(set(DEBIAN_PACKAGES.values()) - {package}))
    return (
        f"Blender cannot be loaded: the system library {missing[1]} is missing. "
        f"On Debian or Ubuntu: apt-get install {package} (it may also need {others})"
    )


@contextlib.contextmanager
def silenced(log: Path, streams: Sequence[int] = (1, 2)) -> Iterator[None]:
    """Send what Blender prints, below Python's own streams, to the end of a file."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(stream) for stream in streams]
    sink = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    try:
        for stream in streams:
            os.dup2(sink, stream)
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for stream, own in zip(streams, kept, strict=True):
            os.dup2(own, stream)
        for descriptor in (*kept, sink):
            os.close(descriptor)


try:
    # Since 5.0 it says on the standard output which colours it uses.
    with silenced(Path(os.devnull), streams=(1,)):
        import bpy
except ImportError as error:
    raise Unusable(import_remedy(error)) from error


def _handlers() -> dict[str, list[Any]]:
    found = ((name, getattr(bpy.app.handlers, name)) for name in dir(bpy.app.handlers))
    return {name: handlers for name, handlers in found if isinstance(handlers, list)}


_OWN_HANDLERS = {name: list(handlers) for name, handlers in _handlers().items()}


def release() -> None:
    """Take down the Python handlers added since the import: with one left, bpy hangs when the process ends."""
    for name, handlers in _handlers().items():
        handlers[:] = _OWN_HANDLERS[name]


def check(result: set[str], action: str) -> None:
    """Raise RenderError unless an operator finished."""
    if "FINISHED" not in result:
        raise RenderError(f"Blender gave up on {action}")
