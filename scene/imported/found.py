"""What was found of materials in a mesh file, and how files are called that it names."""

from __future__ import annotations

import posixpath
import re
from dataclasses import dataclass

from render.texturing.spec import ImportedMaterial
from scene.assets import IN_PACKAGE
from scene.settings import Refused

_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")


@dataclass(frozen=True)
class Found:
    """The materials of a file by their numbers in it."""

    materials: tuple[ImportedMaterial, ...] = ()
    left_out: tuple[str, ...] = ()
    """What of them no picture shows, in words."""
    files: tuple[str, ...] = ()
    """Other files that were read, as a scene would name them."""


def beside(file: str, name: str) -> str:
    """What a file, which a scene calls `file`, calls `name`, as the scene would call it.

    Raises Refused for an address, and for a name that controls a terminal.
    Whether it may be read, `scene.assets` decides.
    """
    if not name.isprintable():
        raise Refused(f"{file!r} names {name!r}, which cannot be printed", remedy="Rename that file")
    if _ADDRESS.match(name):
        raise Refused(f"{file!r} names {name!r}, and nothing is fetched", remedy="Keep it beside the mesh, as a file")
    package = IN_PACKAGE.fullmatch(file)
    folder = posixpath.dirname(package["path"] if package else file)
    path = posixpath.normpath(posixpath.join(folder, name.replace("\\", "/")))
    if path.startswith("~"):
        path = f"./{path}"
    return f"{package['package']}:{path}" if package else path


def printable(text: str) -> str:
    """Words of a file for a message: short, and nothing that controls a terminal."""
    return "".join(sign if sign.isprintable() else "?" for sign in text[:100])
