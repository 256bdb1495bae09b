"""Triangles from files in the formats that are read."""

from __future__ import annotations

import json
import zipfile
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from common.imported import gltf, wavefront
from scene.settings import Refused
from sim.geometry.triangles import MATERIAL, UV, vertex_colors

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

    Lengths are the file's numbers, but metres where it names their unit, as 3MF does. Faces have the attributes UV,
    places in a texture at their corners, shape [m, 3, 2], and MATERIAL, the number of their material in the file or -1,
    shape [m], where the file has such.

    No other file is read, whatever it names: of materials there is only the number.

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
        loaded = _built(path) if kind == ".3mf" else _READERS.get(kind, _plain)(path)
        vertices, faces = np.asarray(loaded.vertices), np.asarray(loaded.faces)
        colors = vertex_colors(loaded)
    except Refused:
        raise
    except Exception as error:  # every format's reader raises errors of its own
        raise Refused(
            f"{path.name!r} cannot be read as a triangle mesh ({type(error).__name__}: {error})",
            remedy=f"Give a file with triangles in one of the formats {', '.join(FORMATS.values())}",
        ) from error
    found = trimesh.Trimesh(vertices, faces, vertex_colors=colors, process=False, validate=False)
    found.face_attributes.update(loaded.face_attributes)
    return found


def _plain(path: Path) -> trimesh.Trimesh:
    return _whole(_scene(path, path.read_bytes()), path)


def _scene(path: Path, content: bytes, **options: Any) -> trimesh.Scene:
    """What the bytes of a file hold: without its path there is no way to another file."""
    import trimesh

    kind = path.suffix[1:].lower()
    options |= {"ply": {"skip_materials": True}, "3mf": {"postprocess": False}}.get(kind, {})
    return trimesh.load_scene(BytesIO(content), file_type=kind, process=False, **options)


class _Names:
    """Stands for every file that an OBJ names: materials of these names, and no more."""

    def __init__(self, names: list[str]):
        self._content = "".join(f"newmtl {name}\n" for name in names).encode()

    def __getitem__(self, _name: str) -> bytes:
        return self._content


def _obj(path: Path) -> trimesh.Trimesh:
    content = path.read_bytes()
    names = wavefront.materials(content)
    whole = _whole(_scene(path, content), path)
    if not (names and wavefront.libraries(content)):
        return whole
    # Where faces have materials, the reader leaves out the colours of vertices: so it reads twice.
    named = _whole(_scene(path, content, resolver=_Names(names)), path, {name: at for at, name in enumerate(names)})
    whole.face_attributes.update(named.face_attributes)
    return whole


def _gltf(path: Path) -> trimesh.Trimesh:
    content = path.read_bytes()
    head, rest = gltf.parted(content)
    _refuse_gltf(path, head, len(content))
    numbers = [str(number) for number in range(len(head.get("materials", ())))]
    head = {key: value for key, value in head.items() if key not in {"images", "textures", "samplers"}}
    head["materials"] = [{"name": number} for number in numbers]
    binary = path.suffix.lower() == ".glb"
    content = gltf.joined(head, rest) if binary else json.dumps(head).encode()
    return _whole(_scene(path, content), path, {number: int(number) for number in numbers})


_READERS = {".obj": _obj, ".glb": _gltf, ".gltf": _gltf}


def _whole(scene: trimesh.Scene, path: Path, materials: dict[str, int] | None = None) -> trimesh.Trimesh:
    """All that a scene places, as one mesh; `materials` has their numbers by their names."""
    import trimesh

    placed = [scene.graph[node][1] for node in scene.graph.nodes_geometry]
    triangles = sum(len(scene.geometry[name].faces) for name in placed)
    if triangles > MOST_TRIANGLES:
        raise Refused(
            f"{path.name!r} places {triangles:,} triangles, at most {MOST_TRIANGLES:,} are read",
            remedy="Export a coarser mesh, or fewer copies of it",
        )
    parts = [part for part in scene.dump() if isinstance(part, trimesh.Trimesh)]
    whole: Any = trimesh.util.concatenate(parts)
    whole.face_attributes.update(_attributes(parts, materials or {}))
    return whole


def _attributes(parts: list[trimesh.Trimesh], materials: dict[str, int]) -> dict[str, np.ndarray]:
    """UV and MATERIAL of the faces of all parts, one part after another, where any of them has such."""
    from trimesh.visual import TextureVisuals

    known, places, numbers = False, [], []
    for part in parts:
        visual = part.visual if isinstance(part.visual, TextureVisuals) else None
        uv = None if visual is None or visual.uv is None else np.asarray(visual.uv, dtype=np.float64)
        if uv is not None and uv.shape == (len(part.vertices), 2) and np.isfinite(uv).all():
            known = True
            places.append(uv[part.faces])
        else:
            places.append(np.zeros((len(part.faces), 3, 2)))
        name = None if visual is None else getattr(visual.material, "name", None)
        numbers.append(np.full(len(part.faces), materials.get(str(name), -1)))
    found = {UV: np.concatenate(places)} if known else {}
    if any((number >= 0).any() for number in numbers):
        found[MATERIAL] = np.concatenate(numbers)
    return found


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
        scene = _scene(path, path.read_bytes())
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


def _refuse_gltf(path: Path, head: dict[str, Any], size: int) -> None:
    """Refuse what is in another file, whose change would not be noticed, and more numbers than there are bytes."""
    uris = [item.get("uri", gltf.EMBEDDED) for item in head.get("buffers", ())]
    if apart := [uri for uri in uris if not uri.startswith(gltf.EMBEDDED)]:
        raise Refused(f"{path.name!r} has its triangles in another file, {apart[0]!r}", remedy="Export it as GLB")
    most = max((item.get("count", 0) for item in head.get("accessors", ())), default=0)
    if most > size:
        message = f"{path.name!r} promises {most:,} of a thing, in {size:,} bytes"
        raise Refused(message, remedy="Export it again, as PLY")
