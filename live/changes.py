"""The settings of a running simulation in the page: a folder for every group, a field for every setting."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from live.controls import Control, controls
from scene.document import SceneError

if TYPE_CHECKING:
    import viser

    from live.orders import Orders
    from sim.spec import SimulationSpec

Change = Callable[[dict[str, Any]], None]
PAUSE = 0.15
"""Between two values of a slider that is dragged [s]."""
HELD = 2.0
"""How long a slider that was moved stays where it is, whatever the simulation has [s]."""


@dataclass
class _Field:
    """What shows a setting: several sliders for a vector, else one field."""

    control: Control
    parts: list[Any]
    touched: float = 0.0

    @property
    def value(self) -> Any:
        if self.control.kind == "vector" and self.control.slides:
            return [part.value for part in self.parts]
        value = self.parts[0].value
        return self.control.read(value) if isinstance(value, str) and self.control.kind != "choice" else value

    def show(self, control: Control) -> None:
        """Show the value in force, unless a person is about to change it."""
        typed = not control.slides and control.value == self.control.value
        if typed or time.monotonic() < self.touched + HELD:
            return
        self.control = control
        for part, value in zip(self.parts, _shown(control), strict=True):
            if part.value != value:
                part.value = value


class Changes:
    """The folders of one client; fields stay the same as long as there are the same settings."""

    def __init__(
        self,
        gui: viser.GuiApi,
        tab: viser.GuiTabHandle,
        orders: Orders,
        change: Change,
        tell: Callable[[str], None],
    ):
        self.gui, self.tab, self.orders, self.change, self.tell = gui, tab, orders, change, tell
        self._folders: list[viser.GuiFolderHandle] = []
        self._fields: dict[str, _Field] = {}
        self._spec: SimulationSpec | None = None
        self._found: list[Control] = []

    def show(self, spec: SimulationSpec) -> None:
        """Bring the fields up to the settings in force."""
        if spec is not self._spec:
            self._spec, self._found = spec, controls(spec)
            there = {path: field.control.form for path, field in self._fields.items()}
            if {control.path: control.form for control in self._found} != there:
                self._rebuild(self._found)
        for control in self._found:
            self._fields[control.path].show(control)

    def _rebuild(self, found: list[Control]) -> None:
        for folder in self._folders:
            folder.remove()
        groups: dict[str, list[Control]] = {}
        for control in found:
            groups.setdefault(control.group, []).append(control)
        self._fields = {}
        with self.tab:
            self._folders = [self._add_group(name, members) for name, members in groups.items()]

    def _add_group(self, name: str, members: list[Control]) -> viser.GuiFolderHandle:
        with self.gui.add_folder(name, expand_by_default=name == "gravity") as folder:
            fields = {control.path: self._add_field(control) for control in members}
            self._fields |= fields
            typed = [field for field in fields.values() if not field.control.slides]
            if typed:
                button = self.gui.add_button(f"Set {name}")
                button.on_click(self.orders.steering(lambda: self._set(typed)))
        return folder

    def _add_field(self, control: Control) -> _Field:
        if control.slides:
            return self._add_sliders(control, *control.slides)
        (value,) = _shown(control)
        if control.kind == "choice":
            return _Field(control, [self.gui.add_dropdown(control.label, control.choices, initial_value=value)])
        if control.kind == "truth":
            return _Field(control, [self.gui.add_checkbox(control.label, value)])
        return _Field(control, [self.gui.add_text(control.label, value, hint=control.hint)])

    def _add_sliders(self, control: Control, low: float, high: float) -> _Field:
        values = _shown(control)
        labels = [f"{axis} [{control.unit}]" for axis in "xyz"] if len(values) > 1 else [control.label]
        sliders = [
            self.gui.add_slider(label, low, high, control.notch, value, hint=control.hint)
            for label, value in zip(labels, values, strict=True)
        ]
        field = _Field(control, sliders)

        def slid(event: viser.GuiEvent) -> None:
            if event.client_id is None:
                return
            now = time.monotonic()
            waited, field.touched = now - field.touched < PAUSE, now
            if waited:
                time.sleep(PAUSE)
            if field.touched == now:
                self.orders.steer(event, lambda: self.change({"set": {control.path: field.value}}))

        for slider in sliders:
            slider.on_update(slid)
        return field

    def _set(self, fields: list[_Field]) -> None:
        values = {}
        for field in fields:
            try:
                value = field.value
            except SceneError as error:
                self.tell(str(error))
                return
            if value != field.control.value:
                values[field.control.path] = value
        if values:
            self.change({"set": values})


def _shown(control: Control) -> list[Any]:
    """What the parts of a field show: values within the sliders' bounds, choices, truths, or the text of a file."""
    if control.slides:
        low, high = control.slides
        values = control.value if control.kind == "vector" else [control.value]
        return [min(max(float(value), low), high) for value in values]
    return [control.value if control.kind in ("choice", "truth") else control.shown()]
