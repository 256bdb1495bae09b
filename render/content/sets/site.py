"""Where a set is put up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from render.blender.session import bpy
from render.content.axes import Vector
from render.content.materials import Wet, make_material
from render.content.meshes import add_object
from render.content.sets.images import lay_images
from render.inputs import Box
from render.looks.simple import Known


@dataclass(frozen=True)
class Site:
    """The place of the action, in Blender's axes."""

    box: Box
    """Around the action and the walls that are drawn."""
    height: float
    """Of the ground [m]."""
    reach: float
    """How far the cameras of the film are from the middle of the ground, at most [m]."""
    look: Any
    """Of the ground."""
    basin: Box | None = None
    """Around the containers of which no wall is drawn."""
    known: Known = "all"
    """What its readers know of clear things."""
    wet: Wet | None = None
    """Says how wet the ground is."""

    @property
    def size(self) -> float:
        """Diagonal of the box of the action [m], by which all of a set is measured."""
        return self.box.diagonal

    @property
    def middle(self) -> Vector:
        """Of the ground under the action [m]."""
        x, y, _ = self.box.center
        return (x, y, self.height)

    def beside(self, margin: float) -> tuple[float, float]:
        """Half the extents in x and y of the action with a margin on all sides [m]."""
        low, high = self.box.low, self.box.high
        return ((high[0] - low[0]) / 2 + margin, (high[1] - low[1]) / 2 + margin)

    def material(self, name: str, look: Any = None) -> Any:
        """A material of the set; without a look, that of the ground."""
        wet = self.wet if name == "ground" else None
        return make_material(name, look or self.look, self.size, known=self.known, wet=wet)

    def lay(self, thing: Any) -> None:
        """Lay the images of the look on an object that has it."""
        lay_images(thing, self.look, self.size)


def add_mesh(
    name: str, corners: list[Vector], faces: list[tuple[int, ...]], material: Any, place: Vector, smooth: bool = False
) -> Any:
    """Put a mesh into the scene whose corners are counted from `place` [m]."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    thing = add_object(name, mesh, material)
    thing.location = place
    return thing


def add_slab(name: str, half: tuple[float, float], thickness: float, material: Any, place: Vector) -> Any:
    """Put a plate with rounded edges into the scene, the middle of whose top is at `place` [m]."""
    a, b = half
    corners = [(x, y, z) for z in (-thickness, 0.0) for y in (-b, b) for x in (-a, a)]
    faces: list[tuple[int, ...]] = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    thing = add_mesh(name, corners, faces, material, place)
    edges = thing.modifiers.new("edges", "BEVEL")
    edges.width, edges.segments = thickness / 5, 3
    return thing
