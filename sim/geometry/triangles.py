"""Surfaces as arrays: what is drawn and written of solids, without the library that works on meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import trimesh


class Triangles(NamedTuple):
    """The triangles of a surface, those of closed ones outward."""

    vertices: np.ndarray
    """[m], shape [n, 3]"""
    faces: np.ndarray
    """Indices of vertices, shape [m, 3]."""
    colors: np.ndarray | None = None
    """Red, green, blue and opacity of the vertices from 0 to 255, shape [n, 4]."""

    @classmethod
    def of(cls, mesh: trimesh.Trimesh) -> Triangles:
        """Those of a mesh of the library."""
        return cls(np.asarray(mesh.vertices), np.asarray(mesh.faces), vertex_colors(mesh))

    def mesh(self) -> trimesh.Trimesh:
        """As a mesh of the library, with the same vertices and faces in the same order."""
        import trimesh

        return trimesh.Trimesh(self.vertices, self.faces, vertex_colors=self.colors, process=False)


def vertex_colors(mesh: trimesh.Trimesh) -> np.ndarray | None:
    """Red, green, blue and opacity of the vertices from 0 to 255, shape [n, 4]; None where they have no colours."""
    from trimesh.visual import ColorVisuals

    visual = mesh.visual
    return visual.vertex_colors if isinstance(visual, ColorVisuals) and visual.kind == "vertex" else None
