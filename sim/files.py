"""Files that are whole or not there."""

from __future__ import annotations

import contextlib
import csv
import json
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

FLUID_POINT = np.dtype(
    [(name, "<f4") for name in ("x", "y", "z", "vx", "vy", "vz", "density")] + [("id", "<i4")]
)
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


def write_mesh(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """A binary little-endian PLY mesh: vertices [m], shape [n, 3], and triangles, shape [m, 3]."""
    triangles = np.empty(len(faces), dtype=[("count", "u1"), ("index", "<i4", (3,))])
    triangles["count"] = 3
    triangles["index"] = faces
    header = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {len(vertices)}",
        *(f"property float {axis}" for axis in "xyz"),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    with whole(path) as stream:
        stream.write(("\n".join(header) + "\n").encode())
        stream.write(np.ascontiguousarray(vertices, dtype="<f4").tobytes())
        stream.write(triangles.tobytes())


class Table:
    """A CSV file that grows by whole frames; rows are kept back until `flush`."""

    def __init__(self, path: Path, columns: Iterable[str]):
        self.columns = list(columns)
        self._rows: list[list[Any]] = []
        self._stream = open(path, "w", newline="", encoding="utf-8")
        self._writer = csv.writer(self._stream, lineterminator="\n")
        self._writer.writerow(self.columns)
        self._stream.flush()

    def add(self, *values: Any) -> None:
        self._rows.append([_short(value) for value in values])

    def drop(self) -> None:
        """Forget the rows since the last flush: their steps are to be repeated."""
        self._rows.clear()

    def flush(self) -> None:
        self._writer.writerows(self._rows)
        self._rows.clear()
        self._stream.flush()

    def close(self) -> None:
        self._stream.close()


def _short(value: Any) -> Any:
    if isinstance(value, float | np.floating):
        return f"{value:.9g}" if np.isfinite(value) else ""
    return value
