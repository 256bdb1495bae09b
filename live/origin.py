"""Whether a browser asks from the page itself: any other page that it shows may open connections to this machine, too.

A browser says in the header Origin which page opens a WebSocket (RFC 6455, section 10.2), and asks nobody whether it
may. A name that leads to this machine for a moment only (DNS rebinding) is told by not being one of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from urllib.parse import urlsplit

LOOPBACK = ("127.0.0.1", "::1", "localhost")


def is_own(headers: Mapping[str, str]) -> bool:
    """Whether a request with these headers comes from the page that is served to this machine, also through a tunnel
    from another; or from a program that is no browser, which may do as its user may."""
    origin = headers.get("Origin")
    if origin is None:
        return True
    try:
        asked = urlsplit(origin)
        return asked.hostname in LOOPBACK and asked.netloc.lower() == headers.get("Host", "").lower()
    except ValueError:
        return False
