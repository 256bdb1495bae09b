"""What Blender's exporter leaves out of a .glb: the volume of clear things, which since 5.0 it does not find."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

VOLUME = "KHR_materials_volume"
HEAD, CHUNK = struct.Struct("<4sII"), struct.Struct("<I4s")
"""Magic, version and length of the file; length and kind of a chunk, of which the first is JSON (glTF 2.0, 4.4)."""


def add_volumes(path: Path, volumes: dict[str, dict[str, Any]]) -> None:
    """Give materials, by their names, what KHR_materials_volume says of the inside of what is made of them."""
    data = path.read_bytes()
    magic, version, _ = HEAD.unpack_from(data)
    length, kind = CHUNK.unpack_from(data, HEAD.size)
    start = HEAD.size + CHUNK.size
    scene, rest = json.loads(data[start : start + length]), data[start + length :]
    for material in scene.get("materials", []):
        if material["name"] in volumes:
            material.setdefault("extensions", {})[VOLUME] = volumes[material["name"]]
            material.pop("doubleSided", None)
            scene["extensionsUsed"] = sorted({*scene.get("extensionsUsed", []), VOLUME})
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    whole = HEAD.pack(magic, version, start + len(text) + len(rest)) + CHUNK.pack(len(text), kind) + text + rest
    path.write_bytes(whole)
