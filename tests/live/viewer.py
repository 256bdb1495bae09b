"""A viewer without a picture: speaks the page's protocol, for abuse and for measurements without a browser's work."""

from __future__ import annotations

import itertools
import threading
import time
import uuid
from typing import Any

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [1.0, 1.0, 1.0],
    "near": 0.01,
    "far": 1000.0,
    "image_height": 600,
    "image_width": 800,
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 1.0, 0.0],
}


class Viewer:
    """One connection. It answers pictures at once, and knows the fields that it was sent, by their labels."""

    def __init__(self, port: int, origin: str | None = None):
        self._socket = connect(
            f"ws://127.0.0.1:{port}",
            origin=origin,
            subprotocols=[f"viser-v{viser.__version__}"],
            max_size=None,
            compression=None,
            ping_interval=None,
        )
        self.fields: dict[str, list[str]] = {}
        """Identifiers of what has a label."""
        self.values: dict[str, Any] = {}
        """Of fields, by identifier."""
        self.told: list[str] = []
        """Texts of messages."""
        self.pictures = 0
        self.closed = False
        self._camera(75.0)
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def send(self, **message: Any) -> None:
        self.send_raw(msgspec.msgpack.encode(message))

    def send_raw(self, data: bytes | str) -> None:
        self._socket.send(data)

    def set(self, label: str, value: Any, place: int = 0) -> None:
        """Give a field a value, or press a button."""
        self.send(type="GuiUpdateMessage", uuid=self.wait_for(label)[place], updates={"value": value})

    def press(self, label: str, place: int = 0) -> None:
        self.set(label, True, place)

    def upload(self, label: str, name: str, content: bytes, part: int = 1 << 20) -> None:
        source, transfer = self.wait_for(label)[0], str(uuid.uuid4())
        shared = {"source_component_uuid": source, "transfer_uuid": transfer}
        parts = [content[start : start + part] for start in range(0, len(content), part)]
        self.send(
            type="FileTransferStartUpload",
            **shared,
            filename=name,
            mime_type="",
            part_count=len(parts),
            size_bytes=len(content),
        )
        for number, data in enumerate(parts):
            self.send(type="FileTransferPart", **shared, part_index=number, content=data)

    def wait_for(self, label: str, seconds: float = 30.0) -> list[str]:
        end = time.monotonic() + seconds
        while label not in self.fields:
            assert time.monotonic() < end, (label, sorted(self.fields))
            time.sleep(0.01)
        return self.fields[label]

    def close(self) -> None:
        self._socket.close()
        self._thread.join(10)

    def _camera(self, angle: float) -> None:
        self.send(**CAMERA, fov=angle)

    def _listen(self) -> None:
        decoder = zstandard.ZstdDecompressor()
        try:
            for data in self._socket:
                size = int.from_bytes(data[:8], "little")
                packed = data[16 : 16 + int.from_bytes(data[8:16], "little")]
                for message in msgspec.msgpack.decode(decoder.decompress(packed, size))["messages"]:
                    self._take(message)
        except (ConnectionClosed, OSError):
            pass
        self.closed = True

    def _take(self, message: dict[str, Any]) -> None:
        kind, props = message["type"], message.get("props", {})
        if kind == "SetCameraFovMessage":
            self.pictures += 1
            self._camera(message["fov"])
        elif kind == "NotificationShowMessage":
            self.told.append(props["body"])
        elif kind == "GuiRemoveMessage":
            for known in self.fields.values():
                if message["uuid"] in known:
                    known.remove(message["uuid"])
            self.fields = {label: known for label, known in self.fields.items() if known}
        elif kind.startswith("Gui") and "label" in props:
            self.fields.setdefault(props["label"], []).append(message["uuid"])
            self.values[message["uuid"]] = message.get("value")
        elif kind == "GuiUpdateMessage":
            self.values[message["uuid"]] = message["updates"].get("value", self.values.get(message["uuid"]))

    @property
    def all_fields(self) -> list[str]:
        return list(itertools.chain.from_iterable(self.fields.values()))
