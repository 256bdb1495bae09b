"""How light bodies are against the fluid next to them: closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sim.coupling.fluid_rigid.density_ratio import layer_mass_ratio

LAYER = 20.0


def test_of_a_ball():
    """Layer of the area 4 pi R^2, of which a third counts along any way; to turn moves none."""
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.1)
    found = layer_mass_ratio(ball, np.zeros(3), 2.0, 0.008 * np.eye(3), LAYER)
    assert found == pytest.approx(LAYER * 4 * np.pi * 0.01 / 3 / 2.0, rel=0.01)


def test_of_a_plate_that_moves_along_its_normal():
    """Both faces: 2 A layer / M; about an axis in its middle, where A L^2 / 12 and M L^2 / 12 have the same ratio."""
    plate = trimesh.creation.box(extents=[0.2, 0.001, 0.2])
    mass = 0.1
    inertia = mass / 12 * np.diag([0.04, 0.08, 0.04])
    found = layer_mass_ratio(plate, np.zeros(3), mass, inertia, LAYER)
    assert found == pytest.approx(2 * 0.04 * LAYER / mass, rel=0.01)
