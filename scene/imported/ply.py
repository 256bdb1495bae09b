"""The picture that a PLY file names, as MeshLab writes it: `comment TextureFile NAME`."""

from __future__ import annotations

import re

from render.texturing.spec import PICTURES, ImportedImage, ImportedMaterial
from scene.imported.found import Found, beside
from scene.settings import Refused

_LONGEST_HEAD = 100_000
_TEXTURE = re.compile(rb"^comment TextureFile ([^\r\n]*[^\s])", re.MULTILINE)


def materials_of(file: str, content: bytes) -> Found:
    """One material, with the picture on all faces; none without. Raises Refused for what is no picture."""
    head = content[: max(0, content.find(b"end_header", 0, _LONGEST_HEAD))]
    names = [match[1].decode("utf-8", "replace") for match in _TEXTURE.finditer(head)]
    if not names:
        return Found()
    if not names[0].lower().endswith(PICTURES):
        fix = f"Save it as one of {', '.join(PICTURES)}"
        raise Refused(f"it names {names[0]!r}, which is in no format of pictures that is read", remedy=fix)
    left_out = (f"all pictures but the first, {names[0]!r}",) if len(names) > 1 else ()
    image = ImportedImage(file=beside(file, names[0]))
    return Found((ImportedMaterial(base_map=image),), left_out)
