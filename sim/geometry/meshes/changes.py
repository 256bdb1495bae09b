"""How much of a surface is not where another one is, and a picture of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sim.geometry.distance.closest_points import MeshDistance, cover
from sim.geometry.meshes.winding import WindingNumber

if TYPE_CHECKING:
    import trimesh

# Points at which a surface is compared with the other.
_POINTS = 2_000
# Share of the size below which the two are in one place.
_APART = 1e-5
# Faces of each kind that a picture shows at most.
_DRAWN = 30_000
_GREY, _ADDED, _LOST = "#c9c9c9", "#d62728", "#1f77b4"


def missing(mesh: trimesh.Trimesh, other: trimesh.Trimesh) -> np.ndarray:
    """For each face the area of it that lies nowhere on the other surface, shape [faces]."""
    corners = np.asarray(mesh.vertices)[mesh.faces]
    apart = _APART * float(np.ptp(mesh.vertices, axis=0).max())
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    # Nearly all faces are the other's as well: those need no closer look.
    new, _ = cKDTree(other.triangles_center).query(corners.mean(axis=1), distance_upper_bound=apart)
    rest = np.flatnonzero(np.isinf(new))
    found = np.zeros(len(corners))
    if len(rest):
        points, face, _ = cover(corners[rest], _POINTS)
        distance, away = MeshDistance(other), np.ones(len(points), dtype=bool)
        near = distance.within(points, apart)
        away[near] = distance.unsigned(points[near]) > apart
        found[rest] = area[rest] * np.bincount(face, weights=away) / np.bincount(face)
    return found


def lost(mesh: trimesh.Trimesh, solid: trimesh.Trimesh) -> np.ndarray:
    """For each face the area of it that is neither on the surface of a solid nor inside it, shape [faces]."""
    area = missing(mesh, solid)
    outside = np.flatnonzero(area)
    area[outside[WindingNumber(solid).at(mesh.triangles_center[outside]) > 0]] = 0.0
    return area


def draw(triangles: np.ndarray, added: np.ndarray, gone: np.ndarray, image: Path) -> None:
    """A PNG file of a surface from two sides, with what mending adds to it in red, and what it takes away in blue.

    All are triangles, shape [n, 3, 3].
    """
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    parts = [(added[:_DRAWN], _ADDED), (gone[:_DRAWN], _LOST), (triangles[:_DRAWN], _GREY)]
    corners = np.concatenate([part for part, _ in parts])
    colors = [color for part, color in parts for _ in part]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    figure = Figure(figsize=(10, 5), layout="constrained")
    for place, (elevation, azimuth) in enumerate(((25, -60), (-25, 120)), 1):
        axes = figure.add_subplot(1, 2, place, projection="3d")
        axes.add_collection3d(Poly3DCollection(corners, facecolors=colors, shade=True))
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        axes.set(xlabel="x", ylabel="y", zlabel="z")
        axes.set_box_aspect(np.maximum(high - low, 1e-3 * (high - low).max()))
        axes.view_init(elev=elevation, azim=azimuth)
    figure.suptitle("red: what mending adds; blue: what it takes away")
    image.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(image, dpi=100)
