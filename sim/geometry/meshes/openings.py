"""Where a surface is open, and whether that is a hole in a solid or the mouth of a vessel.

A hole is where a piece of a solid's skin is missing: a lid over it goes on with the surface around. A mouth is where
the wall of a vessel ends: the surface runs into the lid steeply all around, or the lid is large.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sim.geometry.components import groups
from sim.geometry.meshes.topology import edges_of, surface_area
from sim.geometry.meshes.winding import WindingNumber

if TYPE_CHECKING:
    import trimesh

LARGE = 0.05
"""Share of a mesh's area above which the lids of a piece are no mending."""
# A smaller share is a defect however its rim runs.
_SMALL = 1e-3
# Steepness of a mouth: walls of 37 degrees and more. Ragged rims of scans come to 0.34.
_STEEP = 0.6


@dataclass(frozen=True)
class Opening:
    """Edges with one face that hang together. Lengths in the mesh's own unit."""

    points: np.ndarray
    """Vertices of the rim, shape [n, 3]."""
    lid: float
    """Area of the triangles from the rim's edges to its middle."""
    steep: float
    """Sine of the angle between the surface and the lid, its mean along the rim: 0 for a hole in a plane, 1 for the end
    of a tube."""

    @property
    def width(self) -> float:
        """Greatest distance between two of its points along the axes."""
        return float(np.ptp(self.points, axis=0).max())

    @property
    def flat(self) -> bool:
        """Whether its points are in a plane, to 1e-4 of their extent."""
        return _is_flat(self.points, 1e-4)


def openings(piece: trimesh.Trimesh, whole: trimesh.Trimesh) -> list[Opening]:
    """The openings of a piece of a mesh, the widest first; where it adjoins other pieces it is not open."""
    vertices, faces = np.asarray(piece.vertices), np.asarray(piece.faces)
    edge, half = _open_edges(faces)
    _, number = cKDTree(whole.vertices).query(vertices)
    open_in_whole = {tuple(ends) for ends in _open_edges(np.asarray(whole.faces))[0].tolist()}
    own = [tuple(ends) in open_in_whole for ends in number[edge].tolist()]
    if not any(own):
        return []
    (start, end), half = edge[own].T, half[own]
    along = vertices[end] - vertices[start]
    length = np.linalg.norm(along, axis=1)
    a, b, c = np.moveaxis(vertices[faces[half // 3]], 1, 0)
    # In the plane of the face, across the edge and away from it.
    beyond = np.cross(along, np.cross(b - a, c - a))
    beyond *= (length / np.maximum(np.linalg.norm(beyond, axis=1), 1e-300))[:, None]
    _, label = groups(start, end, len(vertices))
    found = []
    for group in np.unique(label[start]):
        own = label[start] == group
        points = vertices[np.unique([start[own], end[own]])]
        spokes = vertices[start[own]] - points.mean(axis=0), vertices[end[own]] - points.mean(axis=0)
        fan = np.cross(*spokes) / 2
        # Across the plane that fits best, whichever way the faces look.
        normal = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][-1]
        steep = abs(beyond[own].sum(axis=0) @ normal) / max(length[own].sum(), 1e-300)
        found.append(Opening(points, float(np.linalg.norm(fan, axis=1).sum()), float(steep)))
    return sorted(found, key=lambda opening: -opening.width)


def mouths(piece: trimesh.Trimesh, whole: trimesh.Trimesh) -> list[Opening]:
    """The openings of a piece of a mesh that no mending may close: its mouths, or all of them where there is much to
    close; none of a piece that is flat."""
    found, area = openings(piece, whole), surface_area(whole)
    if not found or _is_flat(np.asarray(piece.vertices), 1e-6):
        return []
    if sum(opening.lid for opening in found) > LARGE * area:
        return found
    return [opening for opening in found if opening.steep > _STEEP and opening.lid > _SMALL * area]


def within(opening: Opening, solid: trimesh.Trimesh) -> bool:
    """Whether all of its rim is inside a closed mesh."""
    low, high = solid.bounds
    inside = (opening.points > low).all() and (opening.points < high).all()
    return bool(inside and (WindingNumber(solid).at(opening.points) != 0).all())


def _is_flat(points: np.ndarray, share: float) -> bool:
    """Whether points, shape [n, 3], are in a plane to a share of their extent."""
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[-1] <= share * spread[0])


def _open_edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Start and end of the edges with one face, as that runs along them, shape [n, 2], and 3 face + corner of each."""
    edges, _, edge_of = edges_of(faces)
    half = np.flatnonzero(np.bincount(edge_of, minlength=len(edges))[edge_of] == 1)
    return np.column_stack((faces[half // 3, half % 3], faces[half // 3, (half + 1) % 3])), half
