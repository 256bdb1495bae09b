"""Triangle meshes and points from binary little-endian PLY files, with NumPy or without it."""

from __future__ import annotations

import math
import struct
from array import array
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from render.errors import Unusable

np: Any
try:
    import numpy as np
except ImportError:  # an installed Blender may come without
    np = None

_CODES = {
    "char": "b", "int8": "b", "uchar": "B", "uint8": "B",
    "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
    "int": "i", "int32": "i", "uint": "I", "uint32": "I",
    "float": "f", "float32": "f", "double": "d", "float64": "d",
}  # fmt: skip
"""PLY's types as codes of `struct`."""


@dataclass(frozen=True)
class TriangleMesh:
    """Columns of the vertices by name, each of n numbers, and the flat vertex indices [3 m] of m triangles."""

    columns: dict[str, Any]
    triangles: Any

    def vertex_count(self) -> int:
        """Length of the columns."""
        return len(self.columns["x"])

    def has(self, *names: str) -> bool:
        """Whether there are columns of all these names."""
        return all(name in self.columns for name in names)


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    scalars: list[tuple[str, str]]
    """Name and `struct` code of each property; a list property counts as its length and three indices."""


def read_mesh(path: Path) -> TriangleMesh:
    """Read a triangle mesh.

    Raises Unusable when the file is missing or cut short, is not a binary little-endian triangle mesh,
    or holds a number that is not finite or an index beyond the vertices.
    """
    return _read(path, ["vertex", "face"])


def read_cloud(path: Path) -> TriangleMesh:
    """Read points as a mesh without triangles; raises Unusable as `read_mesh` does."""
    return _read(path, ["vertex"])


ANEW = "delete it, and make it anew by the stage before"


def _read(path: Path, wanted: list[str]) -> TriangleMesh:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise Unusable(f"cannot read {path}: {error.strerror}") from error
    try:
        elements, start = _header(data, wanted)
        columns, triangles = _read_numpy(data, elements, start) if np else _read_struct(data, elements, start)
    except (ValueError, struct.error, KeyError, IndexError) as error:
        kind = "triangle mesh" if "face" in wanted else "point cloud"
        raise Unusable(f"{path} is not a whole binary {kind}: {error}\n  fix: {ANEW}") from error
    _check(path, columns, triangles)
    return TriangleMesh(columns, triangles)


def _header(data: bytes, wanted: list[str]) -> tuple[list[_Element], int]:
    end = data.find(b"end_header\n")
    if not data.startswith(b"ply\n") or end < 0:
        raise ValueError("no PLY header")
    elements: list[_Element] = []
    for line in data[:end].decode("ascii", "replace").splitlines():
        match line.split():
            case ["format", kind, _] if kind != "binary_little_endian":
                raise ValueError(f"format {kind}")
            case ["element", name, count]:
                elements.append(_Element(name, int(count), []))
            case ["property", "list", length, index, _]:
                elements[-1].scalars.append(("length", _CODES[length]))
                elements[-1].scalars.extend((f"corner{corner}", _CODES[index]) for corner in range(3))
            case ["property", kind, name]:
                elements[-1].scalars.append((name, _CODES[kind]))
    if [element.name for element in elements[: len(wanted)]] != wanted:
        raise ValueError("expected " + " and ".join({"vertex": "vertices", "face": "faces"}[name] for name in wanted))
    return elements[: len(wanted)], end + len(b"end_header\n")


def _read_numpy(data: bytes, elements: list[_Element], start: int) -> tuple[dict[str, Any], Any]:
    tables = []
    for element in elements:
        dtype = np.dtype([(name, "<" + code) for name, code in element.scalars])
        tables.append(np.frombuffer(data, dtype, element.count, start))
        start += element.count * dtype.itemsize
    columns = {name: tables[0][name] for name, _ in elements[0].scalars}
    if len(tables) == 1:
        return columns, np.empty(0, np.int32)
    faces = tables[1]
    if (faces["length"] != 3).any():
        raise ValueError("a face is not a triangle")
    return columns, np.stack([faces[f"corner{corner}"] for corner in range(3)], axis=1).astype(np.int32).ravel()


def _read_struct(data: bytes, elements: list[_Element], start: int) -> tuple[dict[str, Any], Any]:
    tables: list[dict[str, array]] = []
    for element in elements:
        record = struct.Struct("<" + "".join(code for _, code in element.scalars))
        size = record.size * element.count
        if len(data) < start + size:
            raise ValueError("cut short")
        columns = list(zip(*record.iter_unpack(data[start : start + size]), strict=True))
        columns = columns or [() for _ in element.scalars]
        pairs = zip(element.scalars, columns, strict=True)
        tables.append({name: array(code, column) for (name, code), column in pairs})
        start += size
    if len(tables) == 1:
        return tables[0], array("i")
    vertices, faces = tables
    if any(length != 3 for length in faces["length"]):
        raise ValueError("a face is not a triangle")
    triangles = array("i", bytes(12 * len(faces["length"])))
    for corner in range(3):
        triangles[corner::3] = array("i", faces[f"corner{corner}"])
    return vertices, triangles


def _check(path: Path, columns: dict[str, Any], triangles: Any) -> None:
    count = len(columns["x"])
    for name, column in columns.items():
        finite = np.isfinite(column).all() if np else all(map(math.isfinite, column))
        if not finite:
            raise Unusable(f"{path}: {name} of a vertex is not finite\n  fix: {ANEW}")
    if len(triangles) and not (min_of(triangles) >= 0 and max_of(triangles) < count):
        raise Unusable(f"{path}: a triangle names a vertex beyond the {count} there are\n  fix: {ANEW}")


def min_of(column: Any) -> float:
    """Smallest number of a column."""
    return column.min() if np else min(column)


def max_of(column: Any) -> float:
    """Largest number of a column."""
    return column.max() if np else max(column)
