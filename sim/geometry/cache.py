"""Results of costly functions, kept by the content of what they were computed from."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib.metadata
import os
import tempfile
import warnings
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from scene.settings import canonical_json

Arrays = dict[str, np.ndarray]


def folder() -> Path:
    """`$TIDEMILL_CACHE`, or `tidemill` in the user's cache folder."""
    if chosen := os.environ.get("TIDEMILL_CACHE"):
        return Path(chosen).expanduser()
    return Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "tidemill"


def cached(
    function: str,
    compute: Callable[[], Arrays],
    *,
    arguments: Mapping[str, object],
    arrays: Sequence[np.ndarray],
    sources: Sequence[str],
    packages: Sequence[str] = ("numpy", "scipy"),
) -> Arrays:
    """`compute()`, or what an equal call returned before.

    Calls are equal when the function's name, its arguments (JSON), the bytes of its arrays, the content of
    the source files and the versions of the packages are. Entries are written whole or not at all, so
    that processes may share the folder; one that cannot be read is computed and written again. A folder
    that cannot be written to costs time, never the run.
    """
    entry = folder() / f"{function}-{_key(function, arguments, arrays, sources, packages)}.npz"
    stored = _read(entry)
    if stored is not None:
        return stored
    result = compute()
    _write(entry, result)
    return result


def _key(
    function: str,
    arguments: Mapping[str, object],
    arrays: Sequence[np.ndarray],
    sources: Sequence[str],
    packages: Sequence[str],
) -> str:
    versions = {package: importlib.metadata.version(package) for package in packages}
    digest = hashlib.sha256(canonical_json([function, dict(arguments), versions]).encode())
    for source in sources:
        digest.update(_source_digest(source))
    for array in arrays:
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()[:40]


@functools.cache
def _source_digest(source: str) -> bytes:
    return hashlib.sha256(Path(source).read_bytes()).digest()


def _read(entry: Path) -> Arrays | None:
    try:
        with np.load(entry, allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files}
    except (OSError, ValueError, EOFError, KeyError, IndexError, NotImplementedError, zipfile.BadZipFile, zlib.error):
        return None


def _write(entry: Path, result: dict[str, Any]) -> None:
    temporary = None
    try:
        entry.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=entry.parent, prefix=entry.stem, suffix=".part")
        with os.fdopen(handle, "wb") as stream:
            np.savez(stream, **result)
        os.replace(temporary, entry)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
        _warn_once(str(entry.parent), str(error))


@functools.cache
def _warn_once(where: str, reason: str) -> None:
    warnings.warn(
        f"the cache {where} cannot be written to ({reason}): meshes are repaired and sampled anew in every run. "
        "Set TIDEMILL_CACHE to a writable folder",
        stacklevel=4,
    )
