"""Triangles from files in the formats that are read."""

from __future__ import annotations

import json
import struct
import zipfile
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from scene.settings import Refused
from sim.geometry.triangles import vertex_colors

if TYPE_CHECKING:
    import trimesh

FORMATS = {".obj": "OBJ", ".stl": "STL", ".ply": "PLY", ".off": "OFF", ".glb": "GLB", ".gltf": "glTF", ".3mf": "3MF"}
# The units of 3MF in metres, and what trimesh calls the one that holds where the file names none.
_UNITS = {"micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048, "meter": 1.0}
_UNNAMED = "millimeters"
MOST_BYTES = 1_000_000_000
"""Of what a 3MF holds, unpacked: an archive of a megabyte may otherwise fill the memory."""
MOST_PARTS = 10_000
"""That a 3MF builds: of assemblies that hold each other twice, thirty have a billion parts."""
MOST_TRIANGLES = 50_000_000
"""Of all that a file places: it may place one mesh any number of times."""
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

    No other file is read, whatever it names: materials and textures are left out.

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
        if kind in (".gltf", ".glb"):
            _refuse_gltf(path)
        loaded = _built(path) if kind == ".3mf" else _whole(_scene(path), path)
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


def _scene(path: Path) -> trimesh.Scene:
    """What the bytes of a file hold: without its path there is no way to another file."""
    import trimesh

    kind = path.suffix[1:].lower()
    options: dict[str, Any] = {"ply": {"skip_materials": True}, "3mf": {"postprocess": False}}.get(kind, {})
    return trimesh.load_scene(BytesIO(path.read_bytes()), file_type=kind, process=False, **options)


def _whole(scene: trimesh.Scene, path: Path) -> trimesh.Trimesh:
    """All that a scene places, as one mesh."""
    placed = [scene.graph[node][1] for node in scene.graph.nodes_geometry]
    triangles = sum(len(scene.geometry[name].faces) for name in placed)
    if triangles > MOST_TRIANGLES:
        raise Refused(
            f"{path.name!r} places {triangles:,} triangles, at most {MOST_TRIANGLES:,} are read",
            remedy="Export a coarser mesh, or fewer copies of it",
        )
    return scene.to_mesh()


def _built(path: Path) -> trimesh.Trimesh:
    """What a 3MF builds of its objects [m]."""
    import trimesh

    with zipfile.ZipFile(path) as archive:
        unpacked = sum(item.file_size for item in archive.infolist())
    if unpacked > MOST_BYTES:
        raise Refused(
            f"{path.name!r} unpacks to {unpacked / 1e9:.3g} GB, at most {MOST_BYTES / 1e9:g} GB are read",
            remedy="Export a coarser mesh, or as GLB or PLY",
        )
    try:
        parts = _parts(path)
        if parts > MOST_PARTS:
            raise Refused(
                f"{path.name!r} builds {parts:,} parts, at most {MOST_PARTS:,} are read",
                remedy="Export it as GLB or PLY",
            )
        scene = _scene(path)
    except (StopIteration, KeyError) as error:  # no file of that name in the archive; no item of the build
        raise Refused(
            f"{path.name!r} holds no model (3D/3dmodel.model), or one that lacks a part, as what it builds",
            remedy="Export it again as 3MF, or as OBJ, STL or PLY",
        ) from error
    read = len(scene.graph.nodes_geometry)
    if 0 < read != parts:
        raise Refused(f"of the {parts} parts that {path.name!r} builds, {read} were found", remedy="Export it as GLB")
    unit = scene.metadata["units"]
    if unit not in (*_UNITS, _UNNAMED):
        raise Refused(
            f"{path.name!r} is in the unit {unit!r}, which 3MF does not have",
            remedy=f"Export it in one of {', '.join(_UNITS)}",
        )
    mesh = _whole(scene, path)
    return trimesh.Trimesh(mesh.vertices * _UNITS.get(unit, _UNITS["millimeter"]), mesh.faces, process=False)


def _parts(path: Path) -> int:
    """How many meshes a 3MF builds, through all that holds them."""
    from lxml import etree  # type: ignore[import-untyped]

    held: dict[str, int] = {}
    built = 0
    with zipfile.ZipFile(path) as archive:
        name = next(name for name in archive.namelist() if "3d/3dmodel.model" in name.lower())
        with archive.open(name) as model:
            tags = ("{*}object", "{*}item")
            for _, node in etree.iterparse(model, tag=tags, resolve_entities=False, no_network=True):
                if etree.QName(node).localname == "item":
                    built += held.get(node.attrib["objectid"], 1)
                    continue
                components = [item.attrib["objectid"] for item in node.iter("{*}component")]
                # What stands in a file is held by what follows, and by nothing else.
                held[node.attrib["id"]] = sum(held.get(component, 1) for component in components) or 1
                node.clear()
    return built


def _refuse_gltf(path: Path) -> None:
    """Refuse what is in another file, whose change would not be noticed, and more numbers than there are bytes."""
    content = path.read_bytes()
    if path.suffix.lower() == ".glb":
        (length,) = struct.unpack_from("<I", content, 12)
        header: dict[str, Any] = json.loads(content[20 : 20 + length])
    else:
        header = json.loads(content)
    uris = [item.get("uri", "data:") for item in header.get("buffers", ())]
    if apart := [uri for uri in uris if not uri.startswith("data:")]:
        raise Refused(f"{path.name!r} has its triangles in another file, {apart[0]!r}", remedy="Export it as GLB")
    most = max((item.get("count", 0) for item in header.get("accessors", ())), default=0)
    if most > len(content):
        raise Refused(
            f"{path.name!r} promises {most:,} of a thing, in {len(content):,} bytes", remedy="Export it again, as PLY"
        )
