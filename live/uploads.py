"""Meshes that a viewer sends: kept beside the scene if they are meshes."""

from __future__ import annotations

import ctypes
import os
import re
import sys
from pathlib import Path

from scene.settings import Refused
from sim.geometry.shapes import place
from sim.geometry.spec import MeshFile
from sim.rigid.spec import RigidBody

MESHES = (".stl", ".obj", ".ply", ".off")
MOST_BYTES = 50_000_000


def give_back() -> None:
    """Hand memory that a large upload took back to the system, where its C library would keep it."""
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
        if trim is not None:
            trim(0)


def keep(name: str, content: bytes, folder: Path) -> Path:
    """Write a mesh into a folder; its path from the folder above. Raises Refused for what is no mesh."""
    suffix = Path(name).suffix.lower()
    if suffix not in MESHES:
        raise Refused(f"'{name}' is no mesh", remedy=f"send a file that ends in {', '.join(MESHES)}")
    if len(content) > MOST_BYTES:
        raise Refused(
            f"'{name}' has {len(content) / 1e6:.0f} MB, at most {MOST_BYTES / 1e6:.0f} are taken",
            remedy="send a coarser mesh",
        )
    if folder.resolve() != folder.parent.resolve() / folder.name:
        raise Refused(f"{folder} is a link to {folder.resolve()}", remedy="remove it: uploads stay beside the scene")
    stem = re.sub(r"[^A-Za-z0-9_-]+", "_", Path(name).stem)[:40] or "mesh"
    folder.mkdir(parents=True, exist_ok=True)
    names = (folder / f"{stem}{number or ''}{suffix}" for number in range(10_000))
    file = next(path for path in names if not os.path.lexists(path))
    with file.open("xb") as stream:
        stream.write(content)
    body = RigidBody(shape=MeshFile(type="mesh", file=file.name))
    try:
        place(body.shape, body, folder)
    except Refused:
        file.unlink()
        raise
    return Path(folder.name, file.name)
