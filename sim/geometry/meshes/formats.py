"""Triangles from files in the formats that are read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.geometry.solids import vertex_colors

if TYPE_CHECKING:
    import trimesh

FORMATS = {".obj": "OBJ", ".stl": "STL", ".ply": "PLY", ".off": "OFF", ".glb": "GLB", ".gltf": "glTF", ".3mf": "3MF"}
# The units of 3MF in metres, and what trimesh calls the one that holds where the file names none.
_UNITS = {"micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048, "meter": 1.0}
_UNNAMED = "millimeters"
_EXPORT = "Export it as OBJ, STL or PLY"
_REFUSED = {
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

    Lengths are the file's numbers, but metres where it names their unit, as 3MF does.

    Raises `Refused` for other formats, and for a file that cannot be read as triangles.
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
        loaded = _built(path) if kind == ".3mf" else trimesh.load_scene(path, process=False).to_mesh()
        vertices, faces = np.asarray(loaded.vertices), np.asarray(loaded.faces)
        colors = vertex_colors(loaded)
    except Refused:
        raise
    except Exception as error:  # every format's reader raises errors of its own
        raise Refused(
            f"{path.name!r} cannot be read as a triangle mesh ({type(error).__name__}: {error})",
            remedy=f"Give a file with triangles in one of the formats {', '.join(FORMATS.values())}",
        ) from error
    return trimesh.Trimesh(vertices, faces, vertex_colors=colors, process=False, validate=False)


def _built(path: Path) -> trimesh.Trimesh:
    """What a 3MF builds of its objects [m]."""
    import trimesh

    try:
        scene = trimesh.load_scene(path, process=False)
    except (StopIteration, KeyError) as error:  # no file of that name in the archive; no item of the build
        raise Refused(
            f"{path.name!r} holds no model (3D/3dmodel.model), or one that lacks a part, as what it builds",
            remedy="Export it again as 3MF, or as OBJ, STL or PLY",
        ) from error
    unit = scene.metadata["units"]
    if unit not in (*_UNITS, _UNNAMED):
        raise Refused(
            f"{path.name!r} is in the unit {unit!r}, which 3MF does not have",
            remedy=f"Export it in one of {', '.join(_UNITS)}",
        )
    mesh = scene.to_mesh()
    return trimesh.Trimesh(mesh.vertices * _UNITS.get(unit, _UNITS["millimeter"]), mesh.faces, process=False)


def _refuse_parts(path: Path) -> None:
    """A change of another file would not be noticed, nor is it one that the scene names."""
    buffers = json.loads(path.read_bytes()).get("buffers", ())
    if apart := [buffer["uri"] for buffer in buffers if not buffer.get("uri", "data:").startswith("data:")]:
        raise Refused(f"{path.name!r} has its triangles in another file, {apart[0]!r}", remedy="Export it as GLB")
