"""A viscous film that runs down an incline, as anybody would write it: a block of some layers on a floor.

Under gravity g at the angle theta to the normal of the floor a film of depth h on which nothing drags has the mean
velocity g sin(theta) h^2 / (3 nu) (Nusselt 1916). The front and the end of a block are thinner than that; its middle
takes h^2 / nu to get there. Friction acts between the centres of particles, of which the uppermost are half a spacing
d below the surface: where that is to friction is known to so much, which is d / h of the velocity.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.fluid.solvers import run
from tests.support.in_time import in_time
from tests.support.particles import positions, read_frame, velocities

DEPTH, NU, ANGLE, G = 0.02, 7e-3, np.radians(30), 9.81
WIDE = 60
"""Spacings across the block."""
SLOPES = {"x": [1.0, 0.0, 0.0], "xz": [np.sqrt(0.5), 0.0, np.sqrt(0.5)]}
"""Along the rows of the lattice, or askew to them."""


def film(slope: str, spacing: float) -> dict:
    pull = G * (np.sin(ANGLE) * np.array(SLOPES[slope]) - np.cos(ANGLE) * np.array([0.0, 1.0, 0.0]))
    size = [WIDE * spacing, DEPTH, WIDE * spacing]
    return {
        "fps": 10,
        "gravity": pull.tolist(),
        "fluid": {
            "solver": "dfsph",
            "particle_radius": spacing / 2,
            "viscosity": NU,
            "bodies": {"honey": {"shape": {"type": "box", "size": size}, "position": [0, DEPTH / 2, 0]}},
        },
        "rigid": {"bodies": {"floor": {"shape": {"type": "plane"}}}},
    }


@pytest.mark.parametrize("slope", SLOPES)
@pytest.mark.parametrize("layers", [4, *in_time(8)])
def test_a_film_of_few_layers_runs_as_fast_as_nusselt_says(tmp_path, layers, slope):
    spacing = DEPTH / layers
    points = read_frame(run(film(slope, spacing), tmp_path, 2), 2)
    x, v = positions(points), velocities(points)
    across = WIDE * spacing / 3
    middle = np.abs(x[:, [0, 2]] - x[:, [0, 2]].mean(axis=0)).max(axis=1) < across / 2
    depth = middle.sum() * spacing**3 / across**2
    ratio = v[middle].mean(axis=0) @ SLOPES[slope] / (G * np.sin(ANGLE) * depth**2 / (3 * NU))
    print(f"{layers} layers along {slope}: {ratio:.3f} of the velocity, depth {depth / DEPTH:.3f}")
    assert (1 - 0.5 / layers) ** 2 < ratio < (1 + 0.5 / layers) ** 2
