"""A glass of walls of any thickness, for tests of what is in it."""

from __future__ import annotations

import numpy as np
import trimesh

SPACING, RADIUS = 0.005, 0.035
FLOOR = 0.01


def glass(folder, wall: float) -> None:
    """A cup along y whose inside begins FLOOR above 0, of 96 sides: the area of its inside is that of the circle to
    0.07 %."""
    outer, top = RADIUS + wall, 0.09
    profile = np.array([[0, 0], [outer, 0], [outer, top], [RADIUS, top], [RADIUS, FLOOR], [0, FLOOR]])
    mesh = trimesh.creation.revolve(profile, sections=96)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    mesh.fix_normals()
    mesh.export(folder / "glass.ply")
