"""The page: who looks, who steers, and what each is sent."""

from __future__ import annotations

import contextlib
import hmac
import io
import logging
import secrets
import threading
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import viser
from viser._messages import ShareUrlRequest

from live import origin
from live.panel import Panel
from live.view import View

if TYPE_CHECKING:
    from live.playing.session import Session

log = logging.getLogger(__name__)
RATE = 30
"""Pictures a second that are sent at most."""

LOOK = 0.004
"""Between two looks for somebody who is done with the last picture [s]."""
REFRESH = 0.25
"""Between two refreshes of numbers and plots [s]."""
HANDOVER = 10.0
"""Longest wait for what is being done when somebody takes over [s]."""

warnings.filterwarnings("ignore", message="Queued a .* on a closed connection", category=UserWarning)
"""Viewers may leave while a picture is on its way to them."""


@contextlib.contextmanager
def silent() -> Iterator[None]:
    """What viser prints in spite of `verbose=False` is not shown."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield


@dataclass
class Viewer:
    """One browser that was let in."""

    client: viser.ClientHandle
    view: View
    panel: Panel
    take_over: viser.GuiButtonHandle
    shown: object = None
    """What it was sent last."""
    sent: float = 0.0
    refreshed: float = 0.0


class Page:
    """Serves a session to browsers. One of them steers, the others watch and may take over."""

    def __init__(
        self, session: Session, *, host: str, port: int, token: str | None = None, stop_when_left: bool = False
    ):
        self.session, self.token, self.stop_when_left = session, token, stop_when_left
        self._viewers: dict[int, Viewer] = {}
        self._lock = threading.RLock()
        self._steers: int | None = None
        with silent():
            self.server = viser.ViserServer(host=host, port=port, label="Tidemill", verbose=False)
        # Whoever is connected could have the page published.
        self.server._websock_server.unregister_handler(ShareUrlRequest)
        self.server.gui.configure_theme(dark_mode=False, control_width="large", show_share_button=False)
        self.server.on_client_connect(self._came)
        self.server.on_client_disconnect(self._left)
        self._thread = threading.Thread(target=self._send, daemon=True, name="pictures")
        self._thread.start()

    @property
    def port(self) -> int:
        """The port on which the server listens."""
        return self.server.get_port()

    @property
    def viewers(self) -> list[Viewer]:
        """Those who were let in."""
        with self._lock:
            return list(self._viewers.values())

    def close(self) -> None:
        """Stop serving; browsers lose their connection."""
        with silent():
            self.server.stop()

    def _came(self, client: viser.ClientHandle) -> None:
        token = self.token
        if token is None:
            if self._is_own(client):
                self._let_in(client)
            return
        with client.gui.add_folder("This simulation asks for its token") as folder:
            given = client.gui.add_text("token", "")
            enter = client.gui.add_button("Enter")

        def check(event: viser.GuiEvent) -> None:
            if hmac.compare_digest(given.value.strip().encode(), token.encode()):
                folder.remove()
                self._let_in(client)
            else:
                time.sleep(1.0)
                client.add_notification("Refused", "this is not the token that the terminal shows", color="red")

        enter.on_click(check)

    def _is_own(self, client: viser.ClientHandle) -> bool:
        """Whether a browser asks from this page, and not from one of another site that it shows."""
        connection = self.server._websock_server._live_connections.get(client.client_id)
        if connection is None or connection.request is None:  # it left already
            return False
        headers = connection.request.headers
        if origin.is_own(headers):
            return True
        log.warning("a page of %s asked to steer this simulation, and was refused", headers.get("Origin"))
        client.add_notification("Refused", "open the address that the terminal shows", color="red")
        return False

    def _let_in(self, client: viser.ClientHandle) -> None:
        number = client.client_id
        with self._lock:
            if self._steers is None:
                self._steers = number
        # A click on what is shown before it is heard would be lost.
        with client.atomic():
            view = View(client)
            take = client.gui.add_button("Take over", hint="steer this simulation yourself", visible=False)
            uploads = self.session.script.scene.folder / "uploads"
            panel = Panel(client, self.session, view, lambda: self._steers == number, uploads)
            take.on_click(panel.orders.queued(lambda event: self._take_over(number)))
            view.look_at(self.session.bounds)
        with self._lock:
            self._viewers[number] = Viewer(client, view, panel, take)
            self._show_who_steers()
            self.session.display.watched = True
        if number not in self.server.get_clients():
            self._left(client)

    def _left(self, client: viser.ClientHandle) -> None:
        with self._lock:
            came = self._viewers.pop(client.client_id, None) is not None
            if self._steers == client.client_id:
                self._steers = next(iter(self._viewers), None)
                self._show_who_steers()
            self.session.display.watched = bool(self._viewers)
            if self.stop_when_left and came and not self._viewers:
                self.session.close()

    def _take_over(self, number: int) -> None:
        """Let somebody else steer, when what was being done is done: it would come after what they do next."""
        with self._lock:
            before = None if self._steers is None or self._steers == number else self._viewers.get(self._steers)
            self._steers = number
            self._show_who_steers()
        if before:
            before.panel.orders.finish(HANDOVER)

    def _show_who_steers(self) -> None:
        for number, viewer in self._viewers.items():
            viewer.take_over.visible = number != self._steers

    def _send(self) -> None:
        """Send pictures as they are made, numbers and plots now and then, to those who are done with the last."""
        while self.session.status.mode != "closed":
            for viewer in self.viewers:
                if viewer.view.ready and time.perf_counter() > viewer.sent + 1 / RATE:
                    try:
                        self._send_to(viewer)
                    except Exception:
                        # What one browser does must not keep pictures from the others.
                        log.exception("viewer %d is sent nothing more", viewer.client.client_id)
                        self._left(viewer.client)
            time.sleep(LOOK)

    def _send_to(self, viewer: Viewer) -> None:
        picture, scenery, now = self.session.display.picture, self.session.display.scenery, time.perf_counter()
        if picture is not None and picture.scenery == scenery.number:
            wanted = (id(picture), viewer.view.colouring)
            if viewer.shown != wanted:
                viewer.view.show(picture, scenery)
                viewer.shown, viewer.sent = wanted, now
        if now - viewer.refreshed > REFRESH:
            viewer.refreshed = now
            viewer.panel.refresh()


def new_token() -> str:
    """96 random bits as text, which viewers enter where other machines reach the page."""
    return secrets.token_urlsafe(12)
