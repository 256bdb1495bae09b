"""Where plane walls meet: a lattice of particles in an edge or a corner lies at rest density, and gradients are those
of the density."""

import itertools

import numpy as np
import pytest

from sim.fluid.calibration import lack
from sim.fluid.kernel import cubic_host, lattice

SPACING, H = 0.01, 0.02
WALLS = np.hstack((np.eye(3), np.zeros((3, 1))))
"""Three planes at right angles, the fluid where all coordinates are positive."""


@pytest.fixture
def share(taichi):
    """What walls add at points [m], shape [n, 3]: gradient [1/m] and share of the rest density, shape [n, 4]."""
    import taichi as ti

    from sim.arrays import Vec4Array, numpy_real, real, vec2, vec4
    from sim.fluid.walls import Walls, wall_share

    @ti.kernel
    def ask(count: ti.i32, x: Vec4Array, walls: ti.i32, fit: vec2, planes: Vec4Array, inverse_h: real, out: Vec4Array):
        for i in range(count):
            out[i] = wall_share(x[i].xyz, walls, fit, planes, inverse_h)

    def at(points, planes):
        walls, count = Walls(planes, SPACING, H), len(points)
        x, out = ti.ndarray(vec4, count), ti.ndarray(vec4, count)
        x.from_numpy(np.column_stack((points, np.zeros(count))).astype(numpy_real))
        ask(count, x, walls.count, walls.fit, walls.planes, 1 / H, out)
        return out.to_numpy()

    return at


@pytest.mark.parametrize("meeting", [1, 2, 3])
def test_a_lattice_at_rest_has_its_density_everywhere(share, meeting):
    axis = (np.arange(4) + 0.5) * SPACING
    points = np.array(list(itertools.product(axis, repeat=3)))[:, ::-1]
    around = lattice(SPACING, H)
    weight = cubic_host(np.linalg.norm(around, axis=1), H)
    inside = np.all((points[:, None, :meeting] + around[None, :, :meeting]) > 0, axis=2)
    density = inside @ weight / weight.sum() + share(points, WALLS[:meeting])[:, 3]
    # The share that three walls have in common is of third order in what one adds.
    bound = 1e-5 if meeting < 3 else lack(SPACING, H).density ** 3
    np.testing.assert_allclose(density, 1.0, atol=bound)


@pytest.mark.parametrize("meeting", [1, 2, 3])
def test_the_gradient_is_that_of_the_share(share, meeting):
    points = np.random.default_rng(3).uniform(-0.1 * H, 0.9 * H, (200, 3))
    step = 1e-3 * H
    exact = share(points, WALLS[:meeting])[:, :3]
    for axis in range(3):
        ahead, behind = points.copy(), points.copy()
        ahead[:, axis] += step
        behind[:, axis] -= step
        difference = share(ahead, WALLS[:meeting])[:, 3] - share(behind, WALLS[:meeting])[:, 3]
        np.testing.assert_allclose(difference / (2 * step), exact[:, axis], atol=1e-3 * np.abs(exact).max())
