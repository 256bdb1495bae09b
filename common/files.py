"""Files that are whole or not there."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import os
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np

FLUID_POINT = np.dtype([(name, "<f4") for name in ("x", "y", "z", "vx", "vy", "vz", "density")] + [("id", "<i4")])
"""A particle of `fluid_00042.ply`; world coordinates, SI units."""


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


def write_json(path: Path, data: Any) -> None:
    with whole(path) as stream:
        stream.write(json.dumps(data, indent=2, allow_nan=False).encode() + b"\n")


def write_points(path: Path, points: np.ndarray) -> None:
    """A binary little-endian PLY cloud of FLUID_POINT records, shape [n]."""
    kinds = {"<f4": "float", "<i4": "int"}
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property {kinds[kind]} {name}" for name, kind in points.dtype.descr]
    with whole(path) as stream:
        stream.write(("\n".join([*header, "end_header"]) + "\n").encode())
        stream.write(np.ascontiguousarray(points).tobytes())


def write_mesh(
    path: Path,
    vertices: np.ndarray,
    faces: np.ndarray,
    colors: np.ndarray | None = None,
    velocities: np.ndarray | None = None,
) -> None:
    """A binary little-endian PLY mesh: vertices [m], shape [n, 3], and triangles, shape [m, 3].

    `colors`: red, green and blue of the vertices from 0 to 255; more columns are left out. `velocities` of the vertices
    [m/s], shape [n, 3].
    """
    channels = () if colors is None else ("red", "green", "blue")
    rates = () if velocities is None else ("vx", "vy", "vz")
    points = np.empty(
        len(vertices),
        dtype=[("place", "<f4", (3,)), ("velocity", "<f4", (len(rates),)), ("color", "u1", (len(channels),))],
    )
    points["place"] = vertices
    if velocities is not None:
        points["velocity"] = velocities
    if colors is not None:
        points["color"] = colors[:, :3]
    triangles = np.empty(len(faces), dtype=[("count", "u1"), ("index", "<i4", (3,))])
    triangles["count"] = 3
    triangles["index"] = faces
    header = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {len(vertices)}",
        *(f"property float {name}" for name in ("x", "y", "z", *rates)),
        *(f"property uchar {channel}" for channel in channels),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    with whole(path) as stream:
        stream.write(("\n".join(header) + "\n").encode())
        stream.write(points.tobytes())
        stream.write(triangles.tobytes())


class Table:
    """A CSV file that grows by whole frames; rows are kept back until `flush`.

    `until`: go on after the rows of an earlier run up to this time [s], if there are any.
    """

    def __init__(self, path: Path, columns: Iterable[str], until: float | None = None):
        self.columns = list(columns)
        self._rows: list[list[Any]] = []
        kept = [] if until is None else _rows_until(path, self.columns, until)
        with whole(path) as stream:
            stream.write(_csv([self.columns, *kept]))
        self._stream = path.open("r+b", buffering=0)
        self.mark()

    def add(self, *values: Any) -> None:
        self._rows.append([_short(value) for value in values])

    def drop(self) -> None:
        """Forget the rows since the last flush: their steps are to be repeated."""
        self._rows.clear()

    def mark(self) -> None:
        """Remember the present end, for `undo`."""
        self._size = self._stream.seek(0, os.SEEK_END)

    def flush(self) -> None:
        left = memoryview(_csv(self._rows))
        while left:
            left = left[self._stream.write(left) :]
        self._rows.clear()

    def undo(self) -> None:
        """Take back what was flushed since the last mark, whole or not."""
        self._stream.truncate(self._size)
        self._stream.seek(self._size)

    def close(self) -> None:
        self._stream.close()


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
        if self._file is not None:
            self._file.close()
        self._file, self._size = None, 0


def _rows_until(path: Path, columns: list[str], until: float) -> list[list[str]]:
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            rows = list(csv.reader(stream))
        if not rows or rows[0] != columns:
            return []
        column, last = columns.index("time"), float(_short(until))
        return [row for row in rows[1:] if float(row[column]) <= last]
    except (OSError, ValueError, IndexError):
        return []


def _csv(rows: Iterable[Iterable[Any]]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


def _short(value: Any) -> Any:
    if isinstance(value, float | np.floating):
        return f"{value:.9g}" if np.isfinite(value) else ""
    return value
