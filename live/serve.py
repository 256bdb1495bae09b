"""Plays a scene to browsers until it is ended."""

from __future__ import annotations

import argparse
import sys
import threading
from typing import Any

from common.signals import hand_over
from live.listening import free_port
from live.origin import LOOPBACK
from live.page import Page, new_token
from live.playing.session import Session
from scene.load import Scene


def serve(scene: Scene, options: argparse.Namespace) -> int:
    """Play a scene in this thread until a signal or the page ends it; returns 0. Raises Refused."""
    port = free_port(options.host, options.port)
    session = Session(scene, threads=options.threads, arch=options.arch, history=int(options.history * 1e9))
    token = None if options.host in LOOPBACK else new_token()

    def ended(number: int, frame: Any) -> None:
        session.close()

    hand_over(ended)
    opener = threading.Thread(target=_open, args=(session, options, port, token), daemon=True)
    opener.start()
    if options.play:
        session.play()
    session.run()
    return 0


def _open(session: Session, options: argparse.Namespace, port: int, token: str | None) -> None:
    """Open the page once there is something to see."""
    session.ready.wait()
    page = Page(session, host=options.host, port=port, token=token, stop_when_left=options.stop_when_left)
    if token is not None:
        print(
            f"warning: everybody who reaches {options.host} can see this page, but only who knows the token gets in\n"
            f"token: {token}",
            file=sys.stderr,
        )
    print(f"live: http://{options.host}:{page.port} (Ctrl-C ends it)", file=sys.stderr, flush=True)
