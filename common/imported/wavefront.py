"""Names in OBJ files: of their libraries of materials (MTL), and of the materials that faces have."""

from __future__ import annotations

import re

_LIBRARIES = re.compile(rb"^[ \t]*mtllib[ \t]+([^\r\n]*[^\s])", re.MULTILINE)
_USED = re.compile(rb"^[ \t]*usemtl[ \t]+([^\r\n]*[^\s])", re.MULTILINE)


def libraries(content: bytes) -> list[str]:
    """Files with materials that an OBJ names, once each."""
    return _once(_LIBRARIES, content)


def materials(content: bytes) -> list[str]:
    """Materials that faces have, once each, in the order in which they are named first: so they are numbered."""
    return _once(_USED, content)


def _once(pattern: re.Pattern[bytes], content: bytes) -> list[str]:
    found = (match[1].decode("utf-8", "replace") for match in pattern.finditer(content))
    return list(dict.fromkeys(found))
