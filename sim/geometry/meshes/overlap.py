"""Where the volume of a closed mesh would count twice, or be negative."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import trimesh


# Samples a piece on which its overlap with others is tested.
_OVERLAP_POINTS = 5000
COUNTED_WRONGLY = 1e-3
"""The share of a mesh's volume that may lie where it cuts through itself: the mass is right to that."""
COLUMNS = 10_000
"""Vertical lines along which the volume that counts wrongly is measured."""


def volume_counted_wrongly(mesh: trimesh.Trimesh) -> float:
    """Volume [m^3] within a closed mesh where its winding number is neither 0 nor 1.

    By the midpoint rule over `COLUMNS` vertical lines, along each of which it is exact: an edge of that volume is at
    most half the lines' distance off.
    """
    from sim.geometry.meshes.winding import WindingNumber

    return _volume(mesh, WindingNumber(mesh).counted_wrongly)


def volume_inside_out(mesh: trimesh.Trimesh) -> float:
    """Volume [m^3] of what a closed mesh encloses with its faces inward; as exact as `volume_counted_wrongly`."""
    from sim.geometry.meshes.winding import WindingNumber

    return _volume(mesh, WindingNumber(mesh).length_inside_out)


def columns_over(bounds: np.ndarray) -> np.ndarray:
    """About `COLUMNS` places of vertical lines through a box [m], shape [2, 3], each in a rectangle of the same area;
    shape [n, 2]."""
    low, high = bounds[:, :2]
    extent = high - low
    spacing = np.sqrt(max(extent.prod(), 1e-300) / COLUMNS)
    number = np.clip(np.ceil(extent / spacing), 1, COLUMNS).astype(int)
    x, y = (low[axis] + extent[axis] * (np.arange(number[axis]) + 0.5) / number[axis] for axis in range(2))
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)


def _volume(mesh: trimesh.Trimesh, length: Callable[[np.ndarray], np.ndarray]) -> float:
    return float(length(columns_over(mesh.bounds)).mean() * np.ptp(mesh.bounds[:, :2], axis=0).prod())


def overlapping_pieces(mesh: trimesh.Trimesh) -> int:
    """How many closed pieces of a mesh reach into another one's material, as sampled just below its surface."""
    from sim.geometry.distance.closest_points import cover
    from sim.geometry.meshes.topology import components, signed_volume
    from sim.geometry.meshes.winding import WindingNumber

    pieces, number = components(mesh)
    if number == 1:
        return 0
    depth = 1e-6 * float(np.ptp(mesh.bounds, axis=0).max())
    found = 0
    for index, piece in enumerate(pieces):
        allowed = 0 if signed_volume(piece) > 0 else 1
        corners = piece.vertices[piece.faces]
        points, face, _ = cover(corners, _OVERLAP_POINTS)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        # Just below the surface, so that pieces which only touch are apart.
        points = points - depth * normal[face]
        around = np.zeros(len(points), dtype=np.int64)
        for other, candidate in enumerate(pieces):
            apart = (candidate.bounds[0] > piece.bounds[1]).any() or (candidate.bounds[1] < piece.bounds[0]).any()
            if other != index and not apart:
                around += WindingNumber(candidate).at(points)
        found += bool((around != allowed).any())
    return found
