"""Whether a picture's file ends too early: readers fill what is missing of a JPEG or TIFF with grey, and go on."""

from __future__ import annotations

import struct
from typing import Any

PNG, JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8"
_TIFF = {b"II*\0": "<", b"MM\0*": ">"}
_SCAN, _END = b"\xff\xda", b"\xff\xd9"
_SIZES = {3: "H", 4: "I"}
"""Of the numbers of a TIFF, by their type."""
_WHERE = ((273, 279), (324, 325))
"""Tags of a TIFF with where its strips or tiles begin, and how long they are."""


def cut_off(content: bytes) -> bool:
    """Whether PNG, JPEG or TIFF promise more than there is; of other formats nothing is known."""
    if content.startswith(PNG):
        return b"IEND" not in content[-64:] and not _has_end(content)
    if content.startswith(JPEG):
        return content.rfind(_END) < content.rfind(_SCAN) or _SCAN not in content
    order = _TIFF.get(content[:4])
    return order is not None and _tiff_cut_off(content, order)


def _has_end(png: bytes) -> bool:
    """Whether the chunks of a PNG lead to its last one."""
    start = len(PNG)
    while start + 12 <= len(png):
        length, kind = struct.unpack_from(">I4s", png, start)
        if kind == b"IEND":
            return True
        start += 12 + length
    return False


def _tiff_cut_off(content: bytes, order: str) -> bool:
    """Whether a strip or tile of the first picture reaches beyond the end; TIFF 6.0, Adobe 1992."""
    try:
        tags = _tags(content, order)
        for begins, lengths in _WHERE:
            for begin, length in zip(tags.get(begins, ()), tags.get(lengths, ()), strict=False):
                if begin + length > len(content):
                    return True
    except struct.error:
        return True
    return False


def _tags(content: bytes, order: str) -> dict[int, tuple[Any, ...]]:
    """The whole numbers of the first directory, by their tags."""
    (directory,) = struct.unpack_from(order + "I", content, 4)
    (count,) = struct.unpack_from(order + "H", content, directory)
    found = {}
    for entry in range(count):
        place = directory + 2 + 12 * entry
        tag, kind, number = struct.unpack_from(order + "HHI", content, place)
        if kind in _SIZES:
            layout = f"{order}{number}{_SIZES[kind]}"
            inside = place + 8
            if struct.calcsize(layout) > 4:
                (inside,) = struct.unpack_from(order + "I", content, inside)
            if inside + struct.calcsize(layout) > len(content):
                raise struct.error("beyond the end")
            found[tag] = struct.unpack_from(layout, content, inside)
    return found
