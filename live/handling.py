"""Drag bodies, pin and release cloth, open and close emitters: by one client, in a tab of its own."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from sim.cloth.spec import Side

if TYPE_CHECKING:
    import viser

    from live.orders import Orders
    from live.playing.session import Change, Session
    from sim.spec import SimulationSpec

FOR_EVER = 1e6
"""When an emitter that was opened closes [s]."""
PAUSE = 0.2
"""Between two places that a body is drawn to [s]."""


class Handling:
    """What a hand would do. Parts of it without anything to handle are not shown."""

    def __init__(
        self,
        client: viser.ClientHandle,
        session: Session,
        orders: Orders,
        change: Callable[[Change], None],
    ):
        self.client, self.session, self.orders, self.change = client, session, orders, change
        self._moved = 0.0
        self._held: str | None = None
        self._gizmo: viser.TransformControlsHandle | None = None
        gui = client.gui
        self._nothing = gui.add_markdown("No body obeys forces, there is no cloth and no emitter.")
        with gui.add_folder("Drag a body") as self._bodies:
            self._body = gui.add_dropdown("body", ("",))
            self._drag = gui.add_checkbox("draw it to the handle", False)
            self._drag.on_update(orders.steering(self._grasp))
        with gui.add_folder("Pin cloth") as self._sheets:
            self._sheet = gui.add_dropdown("cloth", ("",))
            self._side = gui.add_dropdown("side", get_args(Side))
            self._button("Pin", lambda: self._pin([*self._pins(), self._side.value]))
            self._button("Release", lambda: self._pin([]))
        with gui.add_folder("Emitters") as self._emitters:
            self._emitter = gui.add_dropdown("emitter", ("",))
            self._button("Open", lambda: self._stop_flow(lambda now: FOR_EVER))
            self._button("Close", lambda: self._stop_flow(lambda now: now))

    def show(self, spec: SimulationSpec) -> None:
        """Bring names up to what there is."""
        bodies = [name for name, body in (spec.rigid.bodies if spec.rigid else {}).items() if body.motion == "dynamic"]
        sheets, emitters = (
            list(spec.cloth.sheets) if spec.cloth else [],
            list(spec.fluid.emitters) if spec.fluid else [],
        )
        for folder, field, names in (
            (self._bodies, self._body, bodies),
            (self._sheets, self._sheet, sheets),
            (self._emitters, self._emitter, emitters),
        ):
            folder.visible = bool(names)
            if names and tuple(names) != field.options:
                field.options = tuple(names)
        self._nothing.visible = not (bodies or sheets or emitters)
        if self._held is not None and self._held not in bodies:
            self._let_go()

    def _button(self, label: str, action: Callable[[], None]) -> None:
        self.client.gui.add_button(label).on_click(self.orders.steering(action))

    def _grasp(self) -> None:
        """Take the body in hand, or let go of it."""
        if not self._drag.value:
            held = self._held
            self._let_go()
            if held is not None:
                self.change({"set": {f"rigid.bodies.{held}.pulls": []}})
            return
        picture, name = self.session.display.picture, self._body.value
        if picture is None or name not in picture.poses:
            self._drag.value = False  # type: ignore[misc]  # viser's setter stands apart from its getter
            return
        self._held = name
        self._gizmo = self.client.scene.add_transform_controls(
            "/handle", scale=0.2, position=picture.poses[name].position, disable_rotations=True
        )
        self._gizmo.on_update(lambda event: self.orders.steer(event, self._draw))
        self._draw()

    def _let_go(self) -> None:
        self._held = None
        self._drag.value = False  # type: ignore[misc]  # viser's setter stands apart from its getter
        if self._gizmo is not None:
            self._gizmo.remove()
            self._gizmo = None

    def _draw(self) -> None:
        """Draw the body to where the handle is, now and then while it is moved."""
        now = time.monotonic()
        waited, self._moved = now - self._moved < PAUSE, now
        if waited:
            time.sleep(PAUSE)
        if self._moved == now and self._gizmo is not None:
            place = [round(float(x), 6) for x in np.asarray(self._gizmo.position)]
            self.change({"set": {f"rigid.bodies.{self._held}.pulls": [{"to": place}]}})

    def _pins(self) -> list[Any]:
        cloth = self.session.spec.cloth
        return [
            pin if isinstance(pin, str) else pin.model_dump(mode="json", exclude_none=True)
            for pin in (cloth.sheets[self._sheet.value].pins if cloth else ())
        ]

    def _pin(self, pins: list[Any]) -> None:
        name = self._sheet.value
        self.change({"set": {f"cloth.sheets.{name}.pins": [pin for k, pin in enumerate(pins) if pin not in pins[:k]]}})

    def _stop_flow(self, at: Callable[[float], float]) -> None:
        path = f"fluid.emitters.{self._emitter.value}.stop"
        self.change(lambda now: {"set": {path: at(now)}})
