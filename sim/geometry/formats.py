"""Triangles from files in the formats that are read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.solids import vertex_colors
from sim.settings import Refused

if TYPE_CHECKING:
    import trimesh

FORMATS = {".obj": "OBJ", ".stl": "STL", ".ply": "PLY", ".off": "OFF", ".glb": "GLB", ".gltf": "glTF"}
_EXPORT = "Export it as OBJ, STL or PLY"
_REFUSED = {
    ".3mf": (
        "is 3MF, which is not read",
        f"{_EXPORT}; 3MF is in millimetres unless it names another unit, and those formats name none: give the `size`, "
        "or export in metres",
    ),
    ".fbx": ("is FBX, whose format is not public", f"{_EXPORT} from a modelling program, as Blender"),
    ".blend": ("is a file of Blender, which holds a scene", f"{_EXPORT} from Blender (File > Export)"),
} | dict.fromkeys(
    (".step", ".stp", ".iges", ".igs", ".brep"),
    (
        "holds curved surfaces, no triangles",
        f"{_EXPORT} from the CAD program, with a deviation below the particle radius",
    ),
)


def read(path: Path) -> trimesh.Trimesh:
    """All triangles of a file as they are there, with the colours of its vertices; objects are placed as it says.

    Raises `Refused` for other formats, and for a file that can not be read as triangles.
    """
    import trimesh

    kind = path.suffix.lower()
    if kind not in FORMATS:
        says, remedy = _REFUSED.get(
            kind, ("is in no format that is read", f"Give one of {', '.join(FORMATS.values())}")
        )
        raise Refused(f"{path.name!r} {says}", remedy=remedy)
    try:
        if kind == ".gltf":
            _refuse_parts(path)
        loaded = trimesh.load(path, force="mesh", process=False)
        vertices, faces = np.asarray(loaded.vertices), np.asarray(loaded.faces)
        colors = vertex_colors(loaded)
    except Refused:
        raise
    except Exception as error:  # every format's reader raises errors of its own
        raise Refused(
            f"{path.name!r} can not be read as a triangle mesh ({type(error).__name__}: {error})",
            remedy=f"Give a file with triangles in one of the formats {', '.join(FORMATS.values())}",
        ) from error
    return trimesh.Trimesh(vertices, faces, vertex_colors=colors, process=False, validate=False)


def _refuse_parts(path: Path) -> None:
    """A change of another file would not be noticed, nor is it one that the scene names."""
    buffers = json.loads(path.read_bytes()).get("buffers", ())
    if apart := [buffer["uri"] for buffer in buffers if not buffer.get("uri", "data:").startswith("data:")]:
        raise Refused(f"{path.name!r} has its triangles in another file, {apart[0]!r}", remedy="Export it as GLB")
