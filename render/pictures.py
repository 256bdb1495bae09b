"""Writing a rendered picture so that no half file is ever taken for a whole one."""

from __future__ import annotations

import os
from pathlib import Path

from render.blender import bpy
from render.errors import RenderError

PNG_END = b"IEND\xaeB`\x82"


def save_picture(path: Path) -> None:
    """Write the last rendering as PNG, under its name only once it is complete.

    Raises RenderError when the folder can not be written or the disk is full.
    """
    part = path.with_name(f".{path.stem}.part.png")
    try:
        bpy.data.images["Render Result"].save_render(str(part))
        with part.open("rb+") as file:
            file.seek(-len(PNG_END), os.SEEK_END)
            if file.read() != PNG_END:
                raise RenderError(f"can not write {path}: the file was cut short; is the disk full?")
            os.fsync(file.fileno())
        part.replace(path)
    except (RuntimeError, OSError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error).strip()
        raise RenderError(f"can not write {path}: {reason}. Is the folder writable, and is the disk full?") from error
    finally:
        part.unlink(missing_ok=True)
