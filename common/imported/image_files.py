"""What is told of an image by its file, before anything opens it: whether that ends too early, and how large it is.

Readers fill what is missing of a JPEG or TIFF with grey, and go on; and a file of a megabyte may hold 60,000 pixels an
edge.
"""

from __future__ import annotations

import struct
from typing import Any

PNG, JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8"
_TIFF = {b"II*\0": "<", b"MM\0*": ">"}
_SCAN, _END = b"\xff\xda", b"\xff\xd9"
_SIZES = {3: "H", 4: "I"}
"""Of the numbers of a TIFF, by their type."""
_EDGES = (256, 257)
"""Tags of its width and height."""
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers of a JPEG that begin a frame."""
_WHERE = ((273, 279), (324, 325))
"""Tags of a TIFF with where its strips or tiles begin, and how long they are."""


MOST_PIXELS = 16_384
"""Along an edge of an image that is opened."""


def too_large(content: bytes) -> bool:
    """Whether a PNG, JPEG or TIFF has more than MOST_PIXELS along an edge; of other formats nothing is known."""
    try:
        return max(_extent(content)) > MOST_PIXELS
    except (struct.error, KeyError, IndexError):
        return False


def _extent(content: bytes) -> tuple[int, ...]:
    if content.startswith(PNG):
        return struct.unpack_from(">II", content, 16)
    if content.startswith(JPEG):
        return _jpeg_extent(content)
    order = _TIFF.get(content[:4])
    if order is None:
        return (0,)
    tags = _tags(content, order)
    return tuple(tags[tag][0] for tag in _EDGES)


def _jpeg_extent(content: bytes) -> tuple[int, ...]:
    """Of the first frame: ITU-T T.81, Annex B."""
    start = len(JPEG)
    while content[start] == 0xFF:
        kind, length = struct.unpack_from(">xBH", content, start)
        if kind in _FRAMES:
            return struct.unpack_from(">HH", content, start + 5)
        start += 2 + length
    return (0,)


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
    """Whether a strip or tile of the first picture reaches beyond the end, by the specification of TIFF 6.0."""
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
