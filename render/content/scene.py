"""The Blender scene of a film: built once, then changed from frame to frame."""

from __future__ import annotations

import functools
import math
from types import SimpleNamespace
from typing import Any

from render.blender.session import bpy
from render.content.axes import triple, z_up
from render.content.bodies import Body
from render.content.camera import Camera
from render.content.caustics import CausticsOfLamps, past_the_sun
from render.content.changing.foam import Foam
from render.content.changing.froth import laid
from render.content.changing.meshes import MovingMesh
from render.content.changing.sheets import Sheet
from render.content.changing.wetness import Wetness
from render.content.containers import add_container, wall_thickness
from render.content.framing import view_of
from render.content.lights import add_lights
from render.content.materials import Wet, default_body_look, default_sheet_look, make_material, make_materials
from render.content.meshes import COLOR_COLUMNS
from render.content.nodes import Caustics
from render.content.ply import TriangleMesh, max_of, min_of, read_cloud, read_mesh
from render.content.sets import add_set
from render.content.sets.ground import add_ground, surface_of
from render.content.sets.site import Site
from render.content.world import add_world
from render.errors import Unusable
from render.inputs import Box, Inputs, Pose
from render.looks.fluid.froth import cover
from render.looks.simple import Known
from render.texturing.nodes import places

SUNK = 0.002
"""How far water that stands on the ground is sunk into it, over the diagonal of the action's box: they then meet
without a film of air, which would mirror."""
SUNK_BESIDE_CLOTH = 0.5
"""Likewise at most, over the height at which the middle of cloth lies on the ground: it hides no cloth."""


WATER = 1.333
"""Index of refraction around bubbles, where the look of the water has none."""


class Scene:
    """Everything that is in the picture.

    `settings` is the dumped RenderSpec as nested namespaces; raises Unusable for files that cannot be drawn. For files
    of which the readers know less of materials than Blender, looks are made simpler, and foam is left out.
    """

    def __init__(self, settings: Any, inputs: Inputs, fps: float, known: Known = "all"):
        self.settings = settings
        self._known = known
        self.inputs = inputs
        self.fps = fps
        self.box = inputs.extent()
        self._bodies: dict[str, Body] = {}
        self._moving_meshes: dict[str, MovingMesh] = {}
        self._wetness = Wetness(inputs, self.box) if inputs.wet and known == "all" else None
        self._add_surroundings(self._add_containers())
        self._add_bodies()
        self._add_moving_meshes()
        self._foams = self._make_foams() if inputs.foam and known == "all" else {}
        self._caustics = CausticsOfLamps(self.box.diagonal) if settings.caustics else None
        self._camera.take_along()

    def read(self, frame: int) -> dict[str, TriangleMesh | None]:
        """What `read_meshes` gives, and where there are some, foam, on the water and, by the names of their objects,
        what is drawn as balls; and how wet all is."""
        meshes = self.read_meshes(frame)
        if self._wetness is not None:
            meshes = self._wetness.read(meshes, frame)
        path, water = self.inputs.bubbles(frame), meshes.get("water")
        if path is not None:
            meshes["foam"] = read_cloud(path)
        if path is not None and water is not None and self._froths:
            meshes["water"], meshes["foam"], meshes["bubbles"] = laid(water, read_cloud(path))
        return meshes

    def read_meshes(self, frame: int) -> dict[str, TriangleMesh | None]:
        """The meshes of a frame that change their shape, by name of their object; None where there is none."""
        paths = {"cloth_" + name: self.inputs.sheet(name, frame) for name in self.inputs.sheets()}
        if self.inputs.surface is not None:
            paths["water"] = self.inputs.water(frame)
        return {name: read_mesh(path) if path else None for name, path in paths.items()}

    def show(self, frame: int, poses: dict[str, Pose], meshes: dict[str, TriangleMesh | None]) -> None:
        """Bring everything to where it is in a frame."""
        exposure = self._exposure()
        self._camera.show(frame, exposure, self.fps)
        for name, body in self._bodies.items():
            body.show(poses.get(name), frame, exposure, self.fps)
        for name, moving in self._moving_meshes.items():
            moving.show(meshes[name])
        for name, foam in self._foams.items():
            points = meshes.get(name)
            if points is not None:
                foam.show(points)
        if self._wetness is not None:
            self._wetness.show(meshes)
        bpy.context.scene.frame_set(frame)
        if self._caustics is not None:
            self._caustics.show()

    def _exposure(self) -> float:
        """How many frames around one motion is needed for: while the shutter is open, and for the pass of motion from
        the frame before to the one after."""
        if self.settings.motion_blur:
            return self.settings.shutter
        return 2.0 if "motion" in self.settings.passes else 0.0

    def key(self, frame: int, poses: dict[str, Pose]) -> None:
        """Keep where bodies and camera are in a frame as keyframes."""
        self._camera.key(frame, self.fps)
        for name, body in self._bodies.items():
            body.key(poses.get(name), frame)

    def moving(self) -> dict[str, MovingMesh]:
        """What changes its shape, by the names that `read_meshes` gives."""
        return self._moving_meshes

    def sampled(self) -> list[Any]:
        """The objects that have another mesh in every frame."""
        things = [moving.thing for moving in self._moving_meshes.values()]
        return things + [foam.thing for foam in self._foams.values()]

    def bodies(self) -> dict[str, Any]:
        """The objects of the bodies by name."""
        return {name: body.thing for name, body in self._bodies.items()}

    def make_material(self, name: str, look: Any, wet: Wet | None = None) -> Any:
        """A material of water, and of all that may be around it."""
        caustics = past_the_sun(self.settings.lights.sun) if self.settings.caustics else None
        return make_material(name, look, self.box.diagonal, caustics=caustics, known=self._known, wet=wet)

    def _look(self, name: str, default: Any) -> Any:
        return getattr(self.settings.materials, name, default)

    def _add_surroundings(self, visible: Box) -> None:
        settings = self.settings
        view = view_of(settings.camera, visible, settings.resolution)
        self._camera = Camera(
            settings.camera,
            lambda time: view_of(settings.camera, visible, settings.resolution, time),
            stand="motion" in settings.passes and settings.camera.projection == "orthographic",
        )
        add_lights(settings.lights, self.box, view)
        add_world(settings.lights.environment, settings.background)
        if not settings.ground.enabled:
            return
        height = self._ground(visible)
        wet = None if self._wetness is None else self._wetness.of_floor(height, settings.ground.material)
        if settings.set == "none":
            ground = add_ground(settings.ground, height, self.box, view, self._known, wet)
            ground.is_shadow_catcher = settings.background.type == "transparent"
        else:
            add_set(settings.set, self._site(visible, height, wet))

    def _site(self, visible: Box, height: float, wet: Wet | None) -> Site:
        """Where the set stands, with room for the camera wherever it goes."""
        settings = self.settings
        times = [key.at for key in settings.camera.keyframes] or [0.0]
        x, y, _ = visible.center
        cameras = (view_of(settings.camera, visible, settings.resolution, time).position for time in times)
        reach = max(visible.diagonal, *(math.dist(place, (x, y, height)) for place in cameras))
        return Site(visible, height, reach, settings.ground.material, self._basin(), self._known, wet)

    def _basin(self) -> Box | None:
        """The box around containers that are not drawn, where each is a box itself."""
        meshes = [read_mesh(path) for name, path in self.inputs.containers().items() if self._look(name, None) is None]
        if not meshes or not all(map(_is_box, meshes)):
            return None
        return functools.reduce(Box.joined, map(_bounds, meshes))

    def _ground(self, visible: Box) -> float:
        """Height of the ground [m]: that of the scene's floor, or the lowest of what is drawn."""
        if self.settings.ground.height is not None:
            return self.settings.ground.height
        floor = self.inputs.floor()
        drawn = any(self._look(name, None) is not None for name in self.inputs.containers())
        height = visible.low[2] if floor.height is None or drawn else floor.height
        if self.inputs.surface is None:
            return height
        sunk = SUNK * self.box.diagonal
        return height + (sunk if floor.cloth is None else min(sunk, SUNK_BESIDE_CLOTH * floor.cloth))

    def _add_containers(self) -> Box:
        """Add what the settings name; returns the box around the action and the walls."""
        size = self.box.diagonal
        visible = self.box
        for name, path in self.inputs.containers().items():
            look = self._look(name, None)
            if look is not None:
                inner = read_mesh(path)
                material = self.make_material(name, look, self._wet_of(f"container_{name}", inner, look))
                add_container(name, inner, self.settings.walls, material, size)
                visible = visible.joined(_bounds(inner).grown(wall_thickness(self.settings.walls, size)))
        return visible

    def _add_bodies(self) -> None:
        for index, (name, path) in enumerate(self.inputs.bodies().items()):
            source = read_mesh(path)
            tinted = source.has(*COLOR_COLUMNS)
            otherwise = default_body_look(index, tinted)
            look = self._look(name, otherwise)
            caustics = Caustics() if self.settings.caustics else None
            size = _bounds(source).diagonal
            wet = self._wet_of(f"body_{name}", source, look)
            kinds: dict[str, Any] = {"caustics": caustics, "known": self._known, "wet": wet}
            materials = make_materials(name, look, size, tinted, otherwise, **kinds)
            rounding = getattr(look, "rounding", 0.0)
            self._bodies[name] = Body(name, source, *materials, uv=places(name, source, look), rounding=rounding)

    def _add_moving_meshes(self) -> None:
        if self.inputs.surface is not None:
            self._moving_meshes["water"] = MovingMesh("water", self.make_material("water", self.settings.water))
        for index, name in enumerate(self.inputs.sheets()):
            look = self._look(name, default_sheet_look(index))
            first = read_mesh(self.inputs.first_of_sheet(name))
            wet = self._wetness is not None
            self._moving_meshes["cloth_" + name] = Sheet(name, look, first, self.box.diagonal, self._known, wet)

    def _wet_of(self, part: str, source: TriangleMesh, look: Any) -> Wet | None:
        return None if self._wetness is None else self._wetness.of(part, source, look)

    @property
    def _froths(self) -> bool:
        """Whether foam lies on the water as a layer."""
        return self.settings.foam.type == "foam" and self.inputs.surface is not None

    def foam_look(self) -> Any:
        """Of what is drawn as balls."""
        look = self.settings.foam
        return SimpleNamespace(type="matte", color=look.color) if look.type == "foam" else look

    def _make_foams(self) -> dict[str, Foam]:
        """What is drawn as balls, by the names of the objects; water gets its layer of foam."""
        looks = {"foam": self.foam_look()}
        if self._froths:
            material = self._moving_meshes["water"].thing.material_slots[0].material
            graph, output, shader = surface_of(material)
            graph.feed(output, "Surface", cover(graph, self.settings.foam, self.box.diagonal, shader))
            ior = getattr(self.settings.water, "ior", WATER)
            build = "render.looks.fluid.froth:bubble"
            looks["bubbles"] = SimpleNamespace(type="bubble", build=build, color=self.settings.foam.color, ior=ior)
        meshes = "motion" in self.settings.passes
        return {name: Foam(self.make_material(name, look), meshes, name) for name, look in looks.items()}


def _bounds(source: TriangleMesh) -> Box:
    columns = [source.columns[axis] for axis in "xyz"]
    if source.vertex_count() == 0:
        raise Unusable("a body or container has a mesh without vertices")
    low, high = (z_up([float(bound(column)) for column in columns]) for bound in (min_of, max_of))
    return Box(triple(map(min, low, high)), triple(map(max, low, high)))


def _is_box(source: TriangleMesh) -> bool:
    """Whether a mesh has corners at those of its bounds alone."""
    columns = ([float(value) for value in source.columns[axis]] for axis in "xyz")
    return all(len({round(value, 6) for value in column}) == 2 for column in columns)


def plain(data: Any) -> Any:
    """Nested dictionaries as nested namespaces."""
    if isinstance(data, dict):
        return SimpleNamespace(**{key: plain(value) for key, value in data.items()})
    return [plain(value) for value in data] if isinstance(data, list) else data
