"""What a viewer can do: buttons, settings, shapes to add, and plots, each for one client."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from viser import uplot

from live.changes import Changes
from live.handling import Handling
from live.orders import Orders
from live.uploads import MESHES, give_back, keep
from live.view import COLOURINGS
from scene.settings import Refused

if TYPE_CHECKING:
    import viser

    from live.playing.session import Change, Session
    from live.view import View

MATERIALS = ("rigid", "fluid", "cloth")
SHAPES = ("box", "sphere", "cylinder", "mesh")
DRAWN_EVERY = 1.0
"""Between two drawings of a plot [s]."""
POINTS = 300
"""Of a plot."""
SHOWN_ERRORS = 20.0
"""Seconds for which a message stays."""


class Panel:
    """The controls of one client. `may` says whether it may steer; what it may not is not carried out."""

    def __init__(
        self, client: viser.ClientHandle, session: Session, view: View, may: Callable[[], bool], uploads: Path
    ):
        self.client, self.session, self.view, self.uploads = client, session, view, uploads
        self.orders = Orders(may, self.tell)
        self._shown_spec: Any = None
        self._mesh: Path | None = None
        self._plotted, self._plotted_at = 0.0, 0.0
        self._gizmo: viser.TransformControlsHandle | None = None
        self.status = client.gui.add_markdown("starting")
        tabs = client.gui.add_tab_group()
        with tabs.add_tab("Play"):
            self._add_player()
            self._add_plots()
        self._changes = Changes(client.gui, tabs.add_tab("Change"), self.orders, self._change, self.tell)
        with tabs.add_tab("Handle"):
            self._handling = Handling(client, session, self.orders, self._change)
        with tabs.add_tab("Add") as self._add_tab:
            self._add_shapes()
        with tabs.add_tab("Save"):
            self._add_saving()
        self.refresh()

    # What is shown

    def refresh(self) -> None:
        """Bring what is shown up to date."""
        status, session = self.session.status, self.session
        lines = [
            f"**{status.mode}** at {status.time:.3f} s, frame {status.frame}",
            f"{status.particles:,} particles, {status.steps_per_second:.0f} steps/s, {status.factor:.3g} of real time",
        ]
        if session.played.waiting:
            lines.append(f"{session.played.waiting} changes wait for the next steps")
        if status.problem:
            lines.append(
                "**"
                + status.problem.replace("\n", "**  \n", 1)
                + "  \ngo back to an earlier frame, or change a setting"
            )
        content = "  \n".join(lines)
        if content != self.status.content:
            self.status.content = content
        if status.kept[1] > 0:
            self._frame.max = max(status.kept[1], 1)
        self._draw_plots()
        spec = session.spec
        self._changes.show(spec)
        if spec is not self._shown_spec:
            self._shown_spec = spec
            self._handling.show(spec)
            names = tuple(reversed(spec.body_names())) or ("",)
            if names != self._names.options:
                self._names.options = names
                self._names.value = names[0]  # type: ignore[misc]  # viser's setter stands apart from its getter

    def tell(self, text: str, *, title: str = "Refused", colour: Literal["red", "teal"] = "red") -> None:
        """Show a message for a while."""
        self.client.add_notification(title, text, auto_close_seconds=SHOWN_ERRORS, color=colour)

    # Parts

    def _add_player(self) -> None:
        gui, session = self.client.gui, self.session
        self._button("Play", session.play)
        self._button("Pause", session.pause)
        self._button("Next frame", session.step)
        self._frame = gui.add_slider("frame", 0, 1, 1, 0, hint="to go back to")
        self._button("Go back", lambda: session.go_back(int(self._frame.value)))
        speed = gui.add_slider("speed", 0.0, 2.0, 0.05, 0.0, hint="of real time at most; 0: as fast as it goes")
        speed.on_update(self.orders.steering(lambda: session.set_speed(speed.value or None)))
        colour = gui.add_dropdown("colour", COLOURINGS, initial_value=self.view.colouring)
        colour.on_update(lambda event: self.view.colour_by(colour.value))

    def _add_plots(self) -> None:
        empty = np.zeros(2)
        axes = (uplot.Axis(label="s"), uplot.Axis(size=60))
        self._energy = self.client.gui.add_uplot(
            (np.arange(2.0), empty, empty, empty),
            (
                uplot.Series(label="s"),
                uplot.Series(label="kinetic", stroke="#d1495b", width=2),
                uplot.Series(label="potential", stroke="#2e86ab", width=2),
                uplot.Series(label="elastic", stroke="#6a994e", width=2),
            ),
            title="energy above its least [J]",
            scales={"x": uplot.Scale(time=False)},
            axes=axes,
            aspect=1.6,
        )
        self._error = self.client.gui.add_uplot(
            (np.arange(2.0), empty),
            (uplot.Series(label="s"), uplot.Series(label="mean", stroke="#8f5fbf", width=2)),
            title="density error [%]",
            scales={"x": uplot.Scale(time=False)},
            axes=axes,
            aspect=1.6,
        )

    def _draw_plots(self) -> None:
        course = self.session.display.course.columns()
        times, now = course["time"], time.monotonic()
        if len(times) < 2 or times[-1] == self._plotted or now < self._plotted_at + DRAWN_EVERY:
            return
        self._plotted, self._plotted_at = times[-1], now
        drawn = {name: column[:: -(-len(times) // POINTS)] for name, column in course.items()}
        energies = [drawn[name] - drawn[name].min() for name in ("kinetic", "potential", "elastic")]
        self._energy.data = (drawn["time"], *energies)
        self._error.data = (drawn["time"], 100.0 * drawn["density_error"])

    def _add_shapes(self) -> None:
        gui = self.client.gui
        self._material = gui.add_dropdown("material", MATERIALS)
        self._shape = gui.add_dropdown("shape", SHAPES, hint="cloth is a sheet of the size along x and z, or a mesh")
        self._size = gui.add_vector3("size [m]", (0.1, 0.1, 0.1), min=(1e-3,) * 3, step=0.01)
        self._density = gui.add_number("density [kg/m³]", 500.0, min=1.0, hint="of a body")
        self._name = gui.add_text("name", "added1")
        self._offer_upload(None)
        place = gui.add_checkbox("place it in the scene", False)
        place.on_update(lambda event: self._place(place.value))
        self._button("Add", self._add)
        gui.add_divider()
        self._names = gui.add_dropdown("name of", ("",))
        self._button("Remove", lambda: self._change({"remove": [self._names.value]}))

    def _place(self, shown: bool) -> None:
        """Show what says where the next shape comes."""
        if self._gizmo is None:
            picture = self.session.display.picture
            at = np.mean(self.session.bounds, axis=0) if picture is not None else np.zeros(3)
            self._gizmo = self.client.scene.add_transform_controls("/place", scale=0.2, position=at)
        self._gizmo.visible = shown

    def _add(self) -> None:
        material, name = self._material.value, self._name.value
        position = [0.0, 0.5, 0.0] if self._gizmo is None else [round(float(x), 6) for x in self._gizmo.position]
        body: dict[str, Any] = {"shape": self._shape_wanted(material), "position": position}
        if self._gizmo is not None and abs(self._gizmo.wxyz[0]) < 1 - 1e-9:
            body["rotation"] = _turns(self._gizmo.wxyz)
        if material == "rigid":
            body |= {"motion": "dynamic", "density": float(self._density.value)}
        self._change({"add": {material: {name: body}}})
        found = re.search(r"\d*$", name)
        number = found.group() if found else ""
        self._name.value = f"{name.removesuffix(number)}{int(number or 1) + 1}"  # type: ignore[misc]  # viser's setter stands apart from its getter

    def _shape_wanted(self, material: str) -> dict[str, Any]:
        x, y, z = (float(value) for value in self._size.value)
        shape = self._shape.value
        if shape == "mesh":
            return {"type": "mesh", "file": str(self._mesh) if self._mesh else "none"}
        if material == "cloth":
            return {"type": "sheet", "size": [x, z]}
        if shape == "sphere":
            return {"type": "sphere", "radius": x / 2}
        if shape == "cylinder":
            return {"type": "cylinder", "radius": x / 2, "height": y}
        return {"type": "box", "size": [x, y, z]}

    def _offer_upload(self, order: float | None) -> None:
        upload = self.client.gui.add_upload_button("Upload a mesh", mime_type=",".join(MESHES), order=order)
        upload.on_upload(self.orders.queued(lambda event: self._uploaded(event, upload)))

    def _uploaded(self, event: viser.GuiEvent, upload: viser.GuiUploadButtonHandle) -> None:
        """Take what was sent, and hold its bytes no longer than that."""
        file, order = upload.value, upload.order
        upload.remove()
        with self._add_tab:
            self._offer_upload(order)
        self.orders.steer(event, lambda: self._keep(file))
        give_back()

    def _keep(self, file: viser.UploadedFile) -> None:
        """Keep a mesh that was sent, if it is one."""
        try:
            self._mesh = keep(file.name, file.content, self.uploads)
        except Refused as refused:
            self.tell(str(refused))
        else:
            self._shape.value = "mesh"  # type: ignore[misc]  # viser's setter stands apart from its getter
            self.tell(f"{self._mesh}: choose where it comes, and add it", title="Uploaded", colour="teal")

    def _add_saving(self) -> None:
        scene = self.session.script.scene
        name = self.client.gui.add_text("name", f"{scene.path.stem}_live")
        self._button("Save as scene", lambda: self._save(name.value))

    def _save(self, name: str) -> None:
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}", name):
            self.tell(f"'{name}' cannot be the name of a scene: use letters, digits, - and _")
            return
        path = self.session.script.scene.path.with_name(f"{name}.yaml")
        if os.path.lexists(path):
            self.tell(f"{path} is there already: choose another name")
            return
        self.session.save(
            path,
            lambda scene: self.tell(
                f"snakemake --cores all renders/{scene.name}", title=f"Saved {path}", colour="teal"
            ),
            self.tell,
        )

    # What happens

    def _change(self, data: Change) -> None:
        self.session.change(data, self.tell)

    def _button(self, label: str, action: Callable[[], None]) -> None:
        self.client.gui.add_button(label).on_click(self.orders.steering(action))


def _turns(quaternion: np.ndarray) -> list[dict[str, Any]]:
    """The turn that a unit quaternion w, x, y, z stands for, as in a scene file."""
    from scipy.spatial.transform import Rotation

    w, x, y, z = quaternion
    turn = Rotation.from_quat([x, y, z, w]).as_rotvec(degrees=True)
    angle = float(np.linalg.norm(turn))
    return [{"axis": [round(float(part), 6) for part in turn / angle], "angle": round(angle, 4)}]
