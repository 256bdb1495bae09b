"""One viewer's picture of the scene."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib import colormaps

if TYPE_CHECKING:
    import viser

    from live.playing.picture import Picture, Scenery

Colouring = Literal["water", "speed", "density error", "material"]
COLOURINGS: tuple[Colouring, ...] = ("water", "speed", "density error", "material")
CONTAINER, CLOTH = (150, 160, 170), (196, 120, 84)
BODIES = [(226, 98, 74), (240, 178, 62), (110, 168, 108), (146, 120, 190), (214, 140, 160), (120, 130, 140)]
FLUIDS = np.array(
    [(46, 134, 193), (38, 166, 154), (126, 87, 194), (236, 151, 31), (92, 164, 84), (214, 72, 110)], np.uint8
)
"""Of fluid bodies and emitters, in their order."""
SLOW = 0.5
"""Where nothing is faster, this speed [m/s] has the brightest colour."""
DENSE = 0.01
"""The compression that the brightest colour stands for."""
MAPS = {"water": ("Blues_r", 0.15, 0.9), "speed": ("viridis", 0, 1), "density error": ("magma", 0, 1)}
"""Colour maps of matplotlib, and which part of each."""
NUDGE = 4e-5
"""Share by which the angle of view changes with each picture: unseen, but the browser answers it."""
PATIENCE = 2.0
"""After which a picture is sent though the last one was not answered [s]."""
_COLOURS = {
    name: (255 * colormaps[colours](np.linspace(low, high, 256))[:, :3]).astype(np.uint8)
    for name, (colours, low, high) in MAPS.items()
}


class View:
    """Shows pictures to one client, and sends of each only what is new."""

    def __init__(self, client: viser.ClientHandle):
        self.client = client
        self.colouring: Colouring = "water"
        self._scenery = -1
        self._sent, self._answered = 0.0, True
        self._angle, self._nudged = client.camera.fov, False
        client.camera.on_update(self._answer)
        self._particles: viser.PointCloudHandle | None = None
        self._solids: dict[str, viser.MeshHandle] = {}
        self._cloths: dict[str, viser.MeshHandle] = {}
        self._edges: list[viser.LineSegmentsHandle] = []
        client.scene.set_up_direction("+y")
        client.scene.configure_default_lights(True, cast_shadow=False)

    def look_at(self, bounds: np.ndarray) -> None:
        """Put the camera so that a box [m], shape [2, 3], is seen."""
        middle, size = bounds.mean(axis=0), float(np.linalg.norm(bounds[1] - bounds[0]))
        self.client.camera.look_at = middle
        self.client.camera.position = middle + size * np.array([0.55, 0.4, 0.85])

    def colour_by(self, name: str) -> None:
        """Choose one of COLOURINGS; anything else is ignored."""
        if name in COLOURINGS:
            self.colouring = name

    @property
    def ready(self) -> bool:
        """Whether the browser is done with the last picture: a slow one is sent fewer, and none has to wait."""
        return self._answered or time.monotonic() > self._sent + PATIENCE

    def _answer(self, camera: Any) -> None:
        self._answered = True

    def show(self, picture: Picture, scenery: Scenery) -> None:
        """Send a picture; the scene is built anew where the scenery is another than before."""
        with self.client.atomic():
            if scenery.number != self._scenery:
                self._build(scenery)
            self._show_particles(picture)
            for name, pose in picture.poses.items():
                if name in self._solids:
                    self._solids[name].position = pose.position
                    self._solids[name].wxyz = pose.quaternion
            for name, points in picture.cloths.items():
                if name in self._cloths:
                    self._cloths[name].vertices = points.astype(np.float32)
            self._ask()
        self.client.flush()

    def _ask(self) -> None:
        """Have the browser answer once it has come to this message."""
        self._sent, self._answered, self._nudged = time.monotonic(), False, not self._nudged
        self.client.camera.fov = self._angle * (1 + NUDGE * self._nudged)

    def colours(self, picture: Picture) -> np.ndarray:
        """Of the particles that are seen, shape [n, 3], red, green, blue from 0 to 255."""
        if self.colouring == "material":
            return FLUIDS[picture.body[picture.seen] % len(FLUIDS)]
        if self.colouring == "density error":
            share = np.abs(picture.density[picture.seen] - 1.0) / DENSE
        else:
            speed = np.linalg.norm(picture.velocity[picture.seen], axis=1)
            fastest = float(np.quantile(speed, 0.99)) if len(speed) else 0.0
            share = speed / max(fastest, SLOW)
        return _COLOURS[self.colouring][(255 * np.clip(share, 0.0, 1.0)).astype(np.uint8)]

    def _show_particles(self, picture: Picture) -> None:
        if not len(picture.points):
            if self._particles is not None:
                self._particles.visible = False
            return
        if self._particles is None:
            self._particles = self.client.scene.add_point_cloud(
                "/fluid",
                picture.points[picture.seen],
                self.colours(picture),
                point_size=0.9 * picture.spacing,
                point_shape="circle",
                precision="float32",
                position=picture.origin,
            )
            return
        self._particles.visible = True
        self._particles.points = picture.points[picture.seen]
        self._particles.colors = self.colours(picture)

    def _build(self, scenery: Scenery) -> None:
        for handle in [*self._solids.values(), *self._cloths.values(), *self._edges]:
            handle.remove()
        self._solids, self._cloths, self._edges = {}, {}, []
        if len(scenery.edges):
            ends = scenery.edges.astype(np.float32)
            drawn = self.client.scene.add_line_segments(
                "/edges", ends, CONTAINER, thickness=1.5, thickness_units="screen"
            )
            self._edges.append(drawn)
        for number, (name, solid) in enumerate(scenery.solids.items()):
            colour = CONTAINER if solid.container else BODIES[number % len(BODIES)]
            self._solids[name] = self.client.scene.add_mesh_simple(
                f"/solids/{name}",
                solid.points.astype(np.float32),
                solid.triangles.astype(np.uint32),
                color=colour,
                opacity=0.12 if solid.container else None,
                flat_shading=solid.container,
                side="double",
                cast_shadow=not solid.container,
            )
        for name, triangles in scenery.cloths.items():
            self._cloths[name] = self.client.scene.add_mesh_simple(
                f"/cloths/{name}",
                np.zeros((int(triangles.max()) + 1, 3), np.float32),
                triangles.astype(np.uint32),
                color=CLOTH,
                side="double",
            )
        self._scenery = scenery.number
