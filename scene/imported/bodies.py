"""The looks that bodies have by the materials of their mesh files."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from render.spec import RenderSpec
from render.texturing.spec import Imported, Place
from scene import assets
from scene.imported import gltf, mtl, ply
from scene.imported.found import Found
from scene.names import Named
from scene.settings import Refused
from sim.geometry.spec import MeshSurface

INSTEAD = "give the body a look of its own in render.materials"


def with_imported(render: RenderSpec, named: Mapping[str, Named], folder: Path) -> RenderSpec:
    """The settings, in which bodies of `named` have the materials of their files, unless they have other looks.

    Raises Refused, located in the scene in this folder, for materials that cannot be read, and for a body that is to
    have those of its file, which brings none.
    """
    looks = dict(render.materials)
    for name, item in named.items():
        look: Any = looks.get(name)
        wanted = isinstance(look, Imported)
        if item.kind != "a rigid body" or (look is not None and not wanted):
            continue
        found = found_in(item.body, folder, item.location)
        if found.materials:
            looks[name] = Imported(type="imported", materials=found.materials)
        elif wanted and not look.materials:
            message = f"the shape of '{name}' is no mesh file that brings materials"
            raise Refused(message, location=("render", "materials", name), remedy="give another type, as plastic")
    return render if looks == render.materials else render.model_copy(update={"materials": looks})


def found_in(body: Any, folder: Path, location: Place) -> Found:
    """What the mesh file of a body brings, nothing without one; raises Refused as `with_imported` does."""
    shape = getattr(body, "shape", None)
    if not isinstance(shape, MeshSurface):
        return Found()
    try:
        return _materials_of(shape.file, folder)
    except Refused as refused:
        raise refused.at(*location, "shape", "file") from None


MOST = 1_000
"""Materials of a file: each becomes one of Blender's."""


def _materials_of(file: str, folder: Path) -> Found:
    kind = Path(file).suffix.lower()
    if kind not in {".obj", ".glb", ".gltf", ".ply"}:
        return Found()
    content = assets.resolve(file, folder).read_bytes()
    try:
        if kind == ".obj":
            found = mtl.materials_of(file, content, functools.partial(_read, folder=folder))
        else:
            found = (ply if kind == ".ply" else gltf).materials_of(file, content)
        if len(found.materials) > MOST:
            raise Refused(f"there are {len(found.materials):,}, at most {MOST:,} are shown", remedy="Join some")
        return found
    except Refused as refused:
        raise Refused(f"of the materials that {file!r} names: {refused.message}", remedy=_or_instead(refused)) from None


def _read(name: str, folder: Path) -> bytes:
    with assets.resolve(name, folder).open("rb") as stream:
        return stream.read(mtl.MOST_BYTES + 1)


def _or_instead(refused: Refused) -> str:
    if not refused.remedy:
        return INSTEAD
    return f"{refused.remedy} Or {INSTEAD}" if refused.remedy.endswith("?") else f"{refused.remedy}; or {INSTEAD}"


def about_image(refused: Refused, place: Place, named: Mapping[str, Named], render: RenderSpec) -> Refused:
    """A refusal of an image at a place within `render:`, located where the scene names it: of an imported material, at
    the mesh file that does."""
    if place[0] != "materials" or not isinstance(render.materials[str(place[1])], Imported):
        return refused.at("render", *place)
    location = (*named[str(place[1])].location, "shape", "file")
    return Refused(f"of the images that it names: {refused.message}", location=location, remedy=_or_instead(refused))
