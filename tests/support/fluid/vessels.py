"""A glass of walls of any thickness, for tests of what is in it."""

from __future__ import annotations

import numpy as np
import trimesh

SPACING, RADIUS = 0.005, 0.035
FLOOR = 0.01


def glass(folder, wall: float, top: float = 0.09) -> None:
    """A cup along y whose inside begins FLOOR above 0 and ends at `top`, of 96 sides: the area of its inside is that of
    the circle to 0.07 %. Its bottom is as thick as its wall."""
    outer, bottom = RADIUS + wall, FLOOR - wall
    profile = np.array([[0, bottom], [outer, bottom], [outer, top], [RADIUS, top], [RADIUS, FLOOR], [0, FLOOR]])
    mesh = trimesh.creation.revolve(profile, sections=96)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    mesh.fix_normals()
    mesh.export(folder / "glass.ply")
