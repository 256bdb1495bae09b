"""PLY files, binary little-endian: point clouds of particles, triangle meshes of bodies, sheets and surfaces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import BinaryIO

import numpy as np

from common.files import whole

FLUID_POINT = np.dtype([(name, "<f4") for name in ("x", "y", "z", "vx", "vy", "vz", "density")] + [("id", "<i4")])
"""A particle of `fluid_00042.ply`; world coordinates, SI units."""
_TYPES = {
    "float": "<f4",
    "float32": "<f4",
    "double": "<f8",
    "float64": "<f8",
    "int": "<i4",
    "int32": "<i4",
    "uint": "<u4",
    "uint32": "<u4",
    "uchar": "u1",
    "uint8": "u1",
}
_LONGEST_HEADER = 10_000
_SURFACE_NAMES = ("x", "y", "z", "nx", "ny", "nz", "vx", "vy", "vz")
_TRIANGLE = np.dtype([("count", "u1"), ("vertices", "<i4", 3)])
_TEXTURED = [("corners", "u1"), ("uv", "<f4", (3, 2))], ["list uchar float texcoord"]
_OF_A_MATERIAL = [("material", "<i4")], ["int texnumber"]
"""What else a triangle may have, under the names that MeshLab gives to it."""


class BadPly(Exception):
    """A file that is not the PLY file that it should be."""


def read_points(path: Path) -> np.ndarray:
    """The vertices of a PLY file as a structured array, one field a property; shape [n].

    Raises BadPly for anything but a complete binary little-endian file with scalar properties,
    and OSError where the file cannot be read.
    """
    content = path.read_bytes()
    layout, count, start = _vertices(path, content)
    return np.frombuffer(content, layout, count, start)


def read_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """The vertices of a mesh that was written here, as `read_points` has them and raising as it does, and its faces:
    indices of vertices, int32, shape [m, 3]."""
    content = path.read_bytes()
    layout, count, start = _vertices(path, content)
    after = start + count * layout.itemsize
    if (len(content) - after) % _TRIANGLE.itemsize:
        raise BadPly(f"{path} has other faces than triangles")
    return np.frombuffer(content, layout, count, start), np.frombuffer(content, _TRIANGLE, offset=after)["vertices"]


def _vertices(path: Path, content: bytes) -> tuple[np.dtype, int, int]:
    """Layout and number of the vertices, and where they start."""
    end = content.find(b"end_header\n", 0, _LONGEST_HEADER)
    lines = content[: max(end, 0)].decode("ascii", "replace").splitlines()
    if lines[:2] != ["ply", "format binary_little_endian 1.0"]:
        raise BadPly(f"{path} is not a binary little-endian PLY file")
    element, count, fields = "", 0, []
    for line in lines[2:]:
        match line.split():
            case ["element", "vertex", number]:
                element, count = "vertex", int(number)
            case ["element", name, _]:
                element = name
            case ["property", kind, name] if element == "vertex":
                if kind not in _TYPES:
                    raise BadPly(f"{path}: the property {name} has the unknown type {kind}")
                fields.append((name, _TYPES[kind]))
            case ["property", *_] if element == "vertex":
                raise BadPly(f"{path}: lists at vertices are not understood")
    layout = np.dtype(fields)
    start = end + len(b"end_header\n")
    if len(content) < start + count * layout.itemsize:
        raise BadPly(f"{path} is cut off: {len(content)} bytes, too few for {count} points")
    return layout, count, start


def columns(points: np.ndarray, names: Sequence[str]) -> np.ndarray:
    """Fields of a structured array as a contiguous float32 array; shape [n, len(names)].

    Raises BadPly where one is missing.
    """
    missing = [name for name in names if name not in (points.dtype.names or ())]
    if missing:
        raise BadPly(f"there is no property {missing[0]}")
    table = np.empty((len(points), len(names)), np.float32)
    for index, name in enumerate(names):
        table[:, index] = points[name]
    return table


def write_surface(
    path: Path,
    vertices: np.ndarray,
    normals: np.ndarray,
    velocities: np.ndarray,
    triangles: np.ndarray,
    attributes: Mapping[str, np.ndarray] = MappingProxyType({}),
) -> None:
    """Write a mesh: positions [m], unit normals and velocities [m/s], shape [n, 3]; vertex indices, shape [m, 3]; and
    further properties of the vertices by name, shape [n]."""
    properties = (*_SURFACE_NAMES, *attributes)
    points = np.empty(len(vertices), [(name, "<f4") for name in properties])
    for names, values in (("xyz", vertices), (("nx", "ny", "nz"), normals), (("vx", "vy", "vz"), velocities)):
        for axis, name in enumerate(names):
            points[name] = values[:, axis]
    for name, column in attributes.items():
        points[name] = column
    with path.open("wb") as file:
        _write_mesh(file, points, [f"float {name}" for name in properties], triangles)


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
    more: Mapping[str, np.ndarray] | None = None,
    *,
    uv: np.ndarray | None = None,
    material: np.ndarray | None = None,
    comments: Sequence[str] = (),
) -> None:
    """A binary little-endian PLY mesh: vertices [m], shape [n, 3], and triangles, shape [m, 3].

    `colors`: red, green and blue of the vertices from 0 to 255; more columns are left out. `velocities` of the vertices
    [m/s], shape [n, 3]. `more`: numbers of the vertices by the names of their properties, shape [n] each. `uv`: places
    in a texture at the corners of triangles, shape [m, 3, 2]; `material`: the number of that of each triangle, shape
    [m].
    """
    more = more or {}
    channels = () if colors is None else ("red", "green", "blue")
    rates = () if velocities is None else ("vx", "vy", "vz")
    points = np.empty(
        len(vertices),
        dtype=[
            ("place", "<f4", (3,)),
            ("velocity", "<f4", (len(rates),)),
            ("more", "<f4", (len(more),)),
            ("color", "u1", (len(channels),)),
        ],
    )
    points["place"] = vertices
    if velocities is not None:
        points["velocity"] = velocities
    for index, values in enumerate(more.values()):
        points["more"][:, index] = values
    if colors is not None:
        points["color"] = colors[:, :3]
    kinds = [f"float {name}" for name in ("x", "y", "z", *rates, *more)] + [f"uchar {channel}" for channel in channels]
    with whole(path) as stream:
        _write_mesh(stream, points, kinds, faces, uv, material, comments)


def _write_mesh(
    stream: BinaryIO,
    points: np.ndarray,
    properties: Sequence[str],
    triangles: np.ndarray,
    uv: np.ndarray | None = None,
    material: np.ndarray | None = None,
    comments: Sequence[str] = (),
) -> None:
    """Vertices, whose `properties` are of the kinds and names given, shape [n]; vertex indices, shape [m, 3]."""
    more = [_TEXTURED] * (uv is not None) + [_OF_A_MATERIAL] * (material is not None)
    faces = np.empty(len(triangles), [*_TRIANGLE.descr, *(field for fields, _ in more for field in fields)])
    faces["count"] = 3
    faces["vertices"] = triangles
    if uv is not None:
        faces["corners"], faces["uv"] = 6, uv
    if material is not None:
        faces["material"] = material
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *(f"comment {comment}" for comment in comments),
        f"element vertex {len(points)}",
        *(f"property {kind}" for kind in properties),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        *(f"property {kind}" for _, kinds in more for kind in kinds),
        "end_header",
    ]
    stream.write(("\n".join(header) + "\n").encode("ascii"))
    stream.write(points.tobytes())
    stream.write(faces.tobytes())
