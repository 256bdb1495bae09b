"""What is in a glTF or GLB file: its head, and the images that it holds. As the specification of glTF 2.0 says."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from typing import Any

EMBEDDED = "data:"
"""Begins the address of what the file itself holds, in base 64."""
_MAGIC, _JSON = b"glTF", b"JSON"
_HEAD, _CHUNK = struct.Struct("<4sII"), struct.Struct("<I4s")


def parted(content: bytes) -> tuple[dict[str, Any], bytes]:
    """The head of a file, and the bytes that follow it: none of a glTF, which is the head alone.

    Raises ValueError for what is neither.
    """
    if not content.startswith(_MAGIC):
        return _object(content), b""
    try:
        length, kind = _CHUNK.unpack_from(content, _HEAD.size)
    except struct.error:
        raise ValueError("it is cut off") from None
    start = _HEAD.size + _CHUNK.size
    if kind != _JSON or len(content) < start + length:
        raise ValueError("it has no head")
    return _object(content[start : start + length]), content[start + length :]


def joined(head: dict[str, Any], rest: bytes) -> bytes:
    """The GLB file of what `parted` gave."""
    text = json.dumps(head).encode()
    text += b" " * (-len(text) % 4)
    size = _HEAD.size + _CHUNK.size + len(text) + len(rest)
    return _HEAD.pack(_MAGIC, 2, size) + _CHUNK.pack(len(text), _JSON) + text + rest


def image(head: dict[str, Any], rest: bytes, index: int) -> bytes:
    """An image that the file holds, as PNG or JPEG; raises ValueError where it holds none of this number."""
    try:
        found = head["images"][index]
        address = found.get("uri")
        if address is not None:
            return _decoded(address)
        view = head["bufferViews"][found["bufferView"]]
        stored = head["buffers"][view["buffer"]].get("uri")
        content = rest[_CHUNK.size :] if stored is None else _decoded(stored)
        start = view.get("byteOffset", 0)
        end = start + view["byteLength"]
    except (KeyError, IndexError, TypeError, AttributeError) as error:
        raise ValueError(f"it holds no image {index}") from error
    if not 0 <= start <= end <= len(content):
        raise ValueError(f"its image {index} is cut off")
    return content[start:end]


def _object(text: bytes) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except RecursionError:
        raise ValueError("its head is nested too deeply") from None
    if not isinstance(found, dict):
        raise ValueError("its head is no object")
    return found


def _decoded(address: str) -> bytes:
    head, _, text = address.partition(",")
    if not head.startswith(EMBEDDED) or not head.endswith(";base64"):
        raise ValueError("it is in another file")
    try:
        return base64.b64decode(text, validate=True)
    except binascii.Error as error:
        raise ValueError("it is cut off") from error
