"""Surfaces as arrays: what is drawn and written of solids, without the library that works on meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import trimesh


UV, MATERIAL = "uv", "material"
"""Attributes of the faces of a mesh of the library: places in a texture at the corners, shape [m, 3, 2], with (0, 0) at
its lower left; number of the material in the file, -1 without, shape [m]."""


class Triangles(NamedTuple):
    """The triangles of a surface, those of closed ones outward."""

    vertices: np.ndarray
    """[m], shape [n, 3]"""
    faces: np.ndarray
    """Indices of vertices, shape [m, 3]."""
    colors: np.ndarray | None = None
    """Red, green, blue and opacity of the vertices from 0 to 255, shape [n, 4]."""
    uv: np.ndarray | None = None
    """Places in a texture at the corners of faces, shape [m, 3, 2]."""
    material: np.ndarray | None = None
    """Number in its file of the material of each face, or -1; shape [m]."""

    @classmethod
    def of(cls, mesh: trimesh.Trimesh) -> Triangles:
        """Those of a mesh of the library."""
        attributes: Any = mesh.face_attributes
        return cls(
            np.asarray(mesh.vertices),
            np.asarray(mesh.faces),
            vertex_colors(mesh),
            attributes.get(UV),
            attributes.get(MATERIAL),
        )

    def mesh(self) -> trimesh.Trimesh:
        """As a mesh of the library, with the same vertices and faces in the same order."""
        import trimesh

        return trimesh.Trimesh(self.vertices, self.faces, vertex_colors=self.colors, process=False)


def vertex_colors(mesh: trimesh.Trimesh) -> np.ndarray | None:
    """Red, green, blue and opacity of the vertices from 0 to 255, shape [n, 4]; None where they have no colours."""
    from trimesh.visual import ColorVisuals

    visual = mesh.visual
    return visual.vertex_colors if isinstance(visual, ColorVisuals) and visual.kind == "vertex" else None
