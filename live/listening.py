"""Where the page can be served: known before, since its server waits for ever where it cannot listen."""

from __future__ import annotations

import errno
import socket

from scene.settings import Refused

TRIED = 100
"""Ports, from the one asked for on."""
LAST = 65535
TAKEN = (errno.EADDRINUSE, errno.EACCES)
"""What another port may be free of: used by another program, or kept for the administrator."""


def free_port(host: str, port: int) -> int:
    """The first port from this one on at which a server can listen at an address of this machine; 0 stands for any.

    Raises Refused for what is no address of this machine, and where none of TRIED ports is free.
    """
    if not 0 <= port <= LAST:
        raise Refused(f"--port {port} is no port", remedy=f"give one from 0, which stands for any, to {LAST}")
    ports = range(port, min(port + TRIED, LAST + 1))
    for candidate in ports:
        try:
            for family, kind, protocol, _, address in socket.getaddrinfo(
                host, candidate, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
            ):
                with socket.socket(family, kind, protocol) as tried:
                    tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                    tried.bind(address)
        except OSError as error:
            if error.errno not in TAKEN or isinstance(error, socket.gaierror):
                raise Refused(
                    f"--host {host} is no address at which this machine can listen: {error.strerror}",
                    remedy="leave --host out for this machine alone, or give 0.0.0.0 for all that reach it",
                ) from error
        except UnicodeError as error:
            raise Refused(f"--host {host} is no name of a machine", remedy="leave --host out") from error
        else:
            return candidate
    raise Refused(
        f"no port from {port} to {ports[-1]} is free at {host}",
        remedy="give another --port, or 0 for any",
    )
