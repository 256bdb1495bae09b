"""Solids with sharp edges, as thin as a particle or pointed, at one size: what fluid might leak into."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import trimesh

SPACING = 0.04
"""Of the particles that meet them [m]."""
TOP = 0.1
"""Height [m] of the highest point of each."""


def export(mesh: trimesh.Trimesh, path: Path) -> None:
    """Write a closed mesh with its faces outward."""
    if mesh.volume < 0:
        mesh.invert()
    assert mesh.is_watertight
    mesh.export(path)


def cup(sides: int, taper: float, radius: float, high: float, wall: float) -> trimesh.Trimesh:
    """A cup of flat sides on the ground, of an inner `radius` [m] at its rim and `taper` times that at its bottom."""
    outer = radius + wall
    outline = np.array([[0, 0], [taper * outer, 0], [outer, high], [radius, high], [taper * radius, wall], [0, wall]])
    mesh = trimesh.creation.revolve(outline, sections=sides)
    mesh.vertices = mesh.vertices[:, [1, 2, 0]]
    return mesh


def sharp_bodies(folder: Path) -> dict[str, dict[str, Any]]:
    """Settings of rigid bodies by name; meshes are written to `folder`."""
    ridge = np.array([[x, y, z] for z in (-0.3, 0.3) for x, y in ((-0.3, -0.3), (0.3, -0.3), (0.0, TOP))])
    sides = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]
    export(trimesh.Trimesh(ridge, sides), folder / "wedge.ply")
    spike = [[0, TOP, 0], [-0.3, -0.3, -0.2], [0.3, -0.3, -0.2], [0, -0.3, 0.3]]
    export(trimesh.Trimesh(spike, [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]), folder / "spike.ply")
    quarter = [{"axis": [0, 0, 1], "angle": 45}]
    return {
        "plate": {"shape": {"type": "box", "size": [0.8, SPACING, 0.8]}, "position": [0, TOP - SPACING / 2, 0]},
        "box": {"shape": {"type": "box", "size": [0.4, 0.4, 0.4]}, "position": [0, TOP - 0.2, 0]},
        "edge up": {
            "shape": {"type": "box", "size": [0.3, 0.3, 0.8]},
            "position": [0, TOP - 0.15 * 2**0.5, 0],
            "rotation": quarter,
        },
        "wedge": {"shape": {"type": "mesh", "file": "wedge.ply"}},
        "spike": {"shape": {"type": "mesh", "file": "spike.ply"}},
    }
