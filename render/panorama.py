"""The panorama that lights a scene. `python -m render.panorama FILE` exits with 2 where Blender cannot read it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from render.blender.session import bpy
from render.errors import Unusable


def load(path: Path) -> Any:
    """The image of a file; raises Unusable where it is none, or cut off: Blender would light the scene in pink."""
    if not path.is_file():  # others may never end, or wait for somebody who writes to them
        raise Unusable(f"lights.environment: there is no file {path}: give the path of a panorama")
    try:
        image = bpy.data.images.load(str(path.resolve()))
    except RuntimeError:
        image = None
    if image is None or not image.size[0]:
        raise Unusable(f"lights.environment: Blender cannot read the panorama {path}: save it as .hdr or .exr again")
    return image


if __name__ == "__main__":
    try:
        load(Path(sys.argv[1]))
    except Unusable as unusable:
        sys.exit(unusable.exit_code)
