"""Writing a rendered picture so that no half file is ever taken for a whole one."""

from __future__ import annotations

import contextlib
import os
import struct
from collections.abc import Iterator
from pathlib import Path

from render.blender import versions
from render.blender.session import bpy
from render.errors import RenderError

SIGNATURE = b"\x89PNG\r\n\x1a\n"
KEPT = {b"IHDR", b"PLTE", b"sRGB", b"gAMA", b"cHRM", b"iCCP", b"IDAT", b"IEND"}
"""Parts of a PNG file that say what it looks like; the others hold dates and render times."""


def save_picture(path: Path) -> None:
    """Write the last rendering as PNG, under its name only once it is complete.

    The same picture has the same bytes. Raises RenderError when the folder cannot be written or the disk is full.
    """
    part = path.with_name(f".{path.stem}.part.png")
    try:
        bpy.data.images["Render Result"].save_render(str(part))
        picture = without_metadata(part.read_bytes())
        with part.open("wb") as file:
            file.write(picture)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except (RuntimeError, OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error).strip()
        raise RenderError(f"cannot write {path}: {reason}. Is the folder writable, and is the disk full?") from error
    finally:
        part.unlink(missing_ok=True)


@contextlib.contextmanager
def passes_beside(path: Path, wanted: bool) -> Iterator[None]:
    """While a frame is rendered, have Blender write its passes, linear light and all, to `path` in OpenEXR; under its
    name only once it is complete. Raises RenderError."""
    if not wanted:
        yield
        return
    render = bpy.context.scene.render
    part = path.with_name(f".{path.stem}.part.exr")
    picture = render.image_settings.file_format, render.image_settings.color_mode, render.image_settings.color_depth
    render.filepath = str(part)
    versions.take_format(render.image_settings, "OPEN_EXR_MULTILAYER", picture[1], "32")
    render.image_settings.exr_codec = "ZIP"
    try:
        yield
        if not part.exists():
            raise RenderError(f"cannot write {path}. Is the folder writable, and is the disk full?")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
        versions.take_format(render.image_settings, *picture)


def without_metadata(png: bytes) -> bytes:
    """A PNG file reduced to the picture; raises ValueError when it is cut short."""
    if not png.startswith(SIGNATURE):
        raise ValueError("the file is not a PNG")
    kept, start, kind = [SIGNATURE], len(SIGNATURE), b""
    while kind != b"IEND":
        if start + 12 > len(png):
            raise ValueError("the file was cut short")
        (length,), kind = struct.unpack_from(">I", png, start), png[start + 4 : start + 8]
        end = start + 12 + length
        if kind in KEPT:
            kept.append(png[start:end])
        start = end
    return b"".join(kept)
