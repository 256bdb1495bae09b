"""A viscous film that runs down an incline, as anybody would write it: a block of four layers on a floor.

Under gravity g at the angle theta to the normal of the floor a film of depth h on which nothing drags has the mean
velocity g sin(theta) h^2 / (3 nu) (Nusselt 1916). The front and the end of a block are thinner than that; in its middle
it takes h^2 / nu to get there. Layers are d thick: where the floor and the surface are to the fluid is known to a
quarter of that, which is 13 % of the velocity of four layers.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.particles import positions, read_frame, velocities
from tests.solvers import run

D, LAYERS, NU, ANGLE, G = 0.005, 4, 7e-3, np.radians(30), 9.81
DEPTH = LAYERS * D
LONG, WIDE = 60 * D, 24 * D


def film(slope: str, **fluid) -> dict:
    """Along x or askew to the rows of the lattice, as the floor's slope has it."""
    along = {"x": np.array([1.0, 0, 0]), "xz": np.array([1.0, 0, 1.0]) / np.sqrt(2)}[slope]
    pull = G * (np.sin(ANGLE) * along - np.cos(ANGLE) * np.array([0, 1.0, 0]))
    honey = {"shape": {"type": "box", "size": [LONG, DEPTH, LONG]}, "position": [0, DEPTH / 2, 0]}
    return {
        "fps": 10,
        "gravity": pull.tolist(),
        "bounds": {"min": [-1, -0.1, -1], "max": [1, 0.5, 1]},
        "fluid": {
            "solver": "dfsph",
            "particle_radius": D / 2,
            "viscosity": NU,
            "bodies": {"honey": honey | fluid.pop("body", {})},
            **fluid,
        },
        "rigid": {"bodies": {"floor": {"shape": {"type": "plane"}}}},
    }


@pytest.mark.parametrize("slope", ["x", "xz"])
def test_a_film_of_four_layers_runs_as_fast_as_nusselt_says(tmp_path, slope):
    out = run(film(slope), tmp_path, 2)
    points = read_frame(out, 2)
    x, v = positions(points), velocities(points)
    middle = np.abs(x[:, [0, 2]] - x[:, [0, 2]].mean(axis=0)).max(axis=1) < LONG / 6
    depth = middle.sum() * D**3 / (LONG / 3) ** 2
    speed = np.linalg.norm(v[middle].mean(axis=0))
    print(slope, depth / DEPTH, speed / (G * np.sin(ANGLE) * depth**2 / (3 * NU)))
    assert speed == pytest.approx(G * np.sin(ANGLE) * depth**2 / (3 * NU), rel=0.13)
