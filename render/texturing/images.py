"""Images: panoramas and textures, files of their own or within a GLB or glTF.

`python -m render.texturing.images FILE NUMBER FILE NUMBER ...` prints, after MARK, the places, from 0, of those that
cannot be read, and exits with 2 where there are such; the number is that of an image in the file, or WHOLE.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from common.imported import gltf
from common.imported.image_files import JPEG, MOST_PIXELS, PNG, cut_off, too_large
from render.blender.session import bpy
from render.errors import Unusable
from render.texturing import MARK, WHOLE

_KEY = "tidemill"
"""The property of images that says what was loaded, so that nothing is loaded twice."""


def load(path: Path, what: str, index: int | None = None, *, data: bool = False) -> Any:
    """The image of a file, or the one of a number in a GLB or glTF; `what` names the setting. `data` are plain numbers,
    no colours.

    Raises Unusable where it is none, too large, or cut off: Blender would show it in pink or grey.
    """
    key = f"{path.absolute()} {index} {data}"
    known = next((image for image in bpy.data.images if image.get(_KEY) == key), None)
    if known is not None:
        return known
    if not path.is_file():  # others may never end, or wait for somebody who writes to them
        raise Unusable(f"{what}: there is no file {path}: give the path of an image")
    image = _own(path) if index is None else _within(path, index)
    if image is None or not image.size[0]:
        number = "" if index is None else f"number {index} of "
        fix = f"save it again, with at most {MOST_PIXELS:,} pixels an edge"
        raise Unusable(f"{what}: Blender cannot read the image {number}{path}: {fix}")
    image[_KEY] = key
    if data:
        image.colorspace_settings.name = "Non-Color"
    return image


def copy(image: Any) -> Any:
    """A copy that may be changed: `load` gives it to nobody else."""
    other = image.copy()
    del other[_KEY]
    return other


def _own(path: Path) -> Any:
    if not _sound(path.read_bytes()):
        return None
    try:
        return bpy.data.images.load(str(path.resolve()))
    except RuntimeError:
        return None


def _within(path: Path, index: int) -> Any:
    try:
        content = gltf.image(*gltf.parted(path.read_bytes()), index)
    except (OSError, ValueError):
        return None
    if not content.startswith((PNG, JPEG)) or not _sound(content):
        return None
    image = bpy.data.images.new(f"{path.stem}_{index}", 1, 1)
    image.pack(data=content, data_len=len(content))
    image.source = "FILE"
    return image


def _sound(content: bytes) -> bool:
    return not cut_off(content) and not too_large(content)


def _unreadable(given: list[str]) -> list[int]:
    """Places of the pairs of a file and a number that cannot be loaded."""
    found = []
    for place, (file, number) in enumerate(zip(given[::2], given[1::2], strict=True)):
        try:
            load(Path(file), "", None if number == WHOLE else int(number))
        except Unusable:
            found.append(place)
    return found


if __name__ == "__main__":
    broken = _unreadable(sys.argv[1:])
    print(MARK, *broken, flush=True)
    sys.exit(Unusable.exit_code if broken else 0)
