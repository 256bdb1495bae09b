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


UNTURNED: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
_CORNERS = ("count", "corner", 3)
_LISTS = {"vertex_indices": _CORNERS, "vertex_index": _CORNERS, "texcoord": ("coordinates", "uv", 6)}
"""Lists at a triangle: what their length and their numbers are called here, and how many there are."""


@dataclass(frozen=True)
class TriangleMesh:
    """Columns of the vertices by name, each of n numbers, and the flat vertex indices [3 m] of m triangles."""

    columns: dict[str, Any]
    triangles: Any
    uv: Any = None
    """Places in a texture at the corners of triangles, flat [6 m]; None without."""
    material: Any = None
    """Number of the material of each triangle [m], -1 for none; None without."""
    turned: tuple[float, ...] = UNTURNED
    """Rotation matrix, row by row, from the axes of what it was made from to its own, in which y is up."""

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
    """Name and `struct` code of each property; a list property counts as its length and its numbers."""


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
        elements, start, turned = _header(data, wanted)
        tables = _tables(data, elements, start)
        columns = tables[0]
        triangles, uv, material = _faces(tables[1]) if "face" in wanted else (array("i"), None, None)
    except (ValueError, struct.error, KeyError, IndexError) as error:
        kind = "triangle mesh" if "face" in wanted else "point cloud"
        raise Unusable(f"{path} is not a whole binary {kind}: {error}\n  fix: {ANEW}") from error
    _check(path, columns, triangles, uv)
    return TriangleMesh(columns, triangles, uv, material, turned)


def _header(data: bytes, wanted: list[str]) -> tuple[list[_Element], int, tuple[float, ...]]:
    """The elements, where their data start, and how the mesh was turned."""
    end = data.find(b"end_header\n")
    if not data.startswith(b"ply\n") or end < 0:
        raise ValueError("no PLY header")
    elements: list[_Element] = []
    turned = UNTURNED
    for line in data[:end].decode("ascii", "replace").splitlines():
        match line.split():
            case ["format", kind, _] if kind != "binary_little_endian":
                raise ValueError(f"format {kind}")
            case ["comment", "turned", *numbers] if len(numbers) == len(UNTURNED):
                turned = tuple(map(float, numbers))
            case ["element", name, count]:
                elements.append(_Element(name, int(count), []))
            case ["property", "list", length, number, name]:
                count_name, stem, most = _LISTS[name]
                elements[-1].scalars.append((count_name, _CODES[length]))
                elements[-1].scalars.extend((f"{stem}{place}", _CODES[number]) for place in range(most))
            case ["property", kind, name]:
                elements[-1].scalars.append((name, _CODES[kind]))
    if [element.name for element in elements[: len(wanted)]] != wanted:
        raise ValueError("expected " + " and ".join({"vertex": "vertices", "face": "faces"}[name] for name in wanted))
    return elements[: len(wanted)], end + len(b"end_header\n"), turned


def _tables(data: bytes, elements: list[_Element], start: int) -> list[dict[str, Any]]:
    """The columns of each element by name, with NumPy or as `array`."""
    tables: list[dict[str, Any]] = []
    for element in elements:
        if np:
            dtype = np.dtype([(name, "<" + code) for name, code in element.scalars])
            table = np.frombuffer(data, dtype, element.count, start)
            tables.append({name: table[name] for name, _ in element.scalars})
            start += element.count * dtype.itemsize
            continue
        record = struct.Struct("<" + "".join(code for _, code in element.scalars))
        size = record.size * element.count
        if len(data) < start + size:
            raise ValueError("cut short")
        columns = list(zip(*record.iter_unpack(data[start : start + size]), strict=True))
        columns = columns or [() for _ in element.scalars]
        pairs = zip(element.scalars, columns, strict=True)
        tables.append({name: array(code, column) for (name, code), column in pairs})
        start += size
    return tables


def _faces(table: dict[str, Any]) -> tuple[Any, Any, Any]:
    """The flat indices of triangles, their places in a texture, and their materials."""
    if any(length != 3 for length in _different(table["count"])):
        raise ValueError("a face is not a triangle")
    if any(length != 6 for length in _different(table.get("coordinates", ()))):
        raise ValueError("a triangle has a place in the texture for another number of corners")
    uv = _flat([table[f"uv{place}"] for place in range(6)], "f") if "uv0" in table else None
    return _flat([table[f"corner{corner}"] for corner in range(3)], "i"), uv, table.get("texnumber")


def _different(column: Any) -> Any:
    return np.unique(column) if np else set(column)


def _flat(columns: list[Any], code: str) -> Any:
    """Columns to one buffer, row by row."""
    if np:
        return np.stack(columns, axis=1).astype(np.dtype(code)).ravel()
    flat = array(code, bytes(array(code).itemsize * len(columns) * len(columns[0])))
    for place, column in enumerate(columns):
        flat[place :: len(columns)] = array(code, column)
    return flat


def _check(path: Path, columns: dict[str, Any], triangles: Any, uv: Any) -> None:
    count = len(columns["x"])
    for name, column in {**columns, **({} if uv is None else {"the place in a texture": uv})}.items():
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
