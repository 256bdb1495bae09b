"""Objects that have another mesh in every frame."""

from __future__ import annotations

from typing import Any

from render.blender.session import bpy
from render.content.meshes import add_object, build_mesh, replace_mesh
from render.content.ply import TriangleMesh


class MovingMesh:
    """An object, which is out of sight in frames without a mesh."""

    def __init__(self, name: str, *materials: Any):
        self.name = name
        self._materials = materials
        self.thing = add_object(name, bpy.data.meshes.new(name), *materials)

    def show(self, source: TriangleMesh | None) -> None:
        """Have the mesh of a frame."""
        self.thing.hide_render = source is None or len(source.triangles) == 0
        if source is not None and not self.thing.hide_render:
            self.take(self.build(source, self.name), source)

    def build(self, source: TriangleMesh, name: str) -> Any:
        """The Blender mesh of a frame."""
        return build_mesh(name, source)

    def take(self, mesh: Any, source: TriangleMesh | None) -> None:
        """Have a mesh that was built."""
        replace_mesh(self.thing, mesh, *self._materials)

    def copy(self, source: TriangleMesh, name: str) -> Any:
        """An object of its own that stays as it is in a frame."""
        thing = add_object(name, self.build(source, name), *self._materials)
        self.finish(thing, source)
        return thing

    def finish(self, thing: Any, source: TriangleMesh) -> None:
        """Add what is drawn besides the mesh."""
