"""Where plane walls are, and meet: a lattice of particles lies at rest density, gradients are those of the density, and
what differs along a wall pushes as it does elsewhere."""

import itertools

import numpy as np
import pytest

from sim.fluid.boundary.calibration import lack
from sim.fluid.kernel import cubic_host, cubic_slope_host, lattice

SPACING, H = 0.01, 0.02
WALLS = np.hstack((np.eye(3), np.zeros((3, 1))))
"""Three planes at right angles, the fluid where all coordinates are positive."""


def faces_at(points, planes):
    """What solids below `planes`, normals and offsets [m], shape [n, 4], are to points [m], shape [n, 3]."""
    from sim.device.arrays import numpy_real, vec4
    from sim.device.compiler import ti
    from sim.fluid.boundary.faces import Faces
    from sim.fluid.boundary.shapes import Shapes, half_space

    count = len(points)
    x, v = ti.ndarray(vec4, count), ti.ndarray(vec4, count)
    x.from_numpy(np.column_stack((points, np.zeros(count))).astype(numpy_real))
    v.fill(0)
    faces = Faces(Shapes([half_space(plane[:3], plane[3]) for plane in planes], np.zeros(3), SPACING, H), SPACING, H, H)
    faces.find(x, count)
    faces.place(faces.points(x, v), count, 0.0)
    return faces


def share(points, planes):
    """What walls add at points [m], shape [n, 3]: gradient [1/m] and share of the rest density, shape [n, 4]."""
    return faces_at(points, planes).share.to_numpy()[: len(points)]


@pytest.mark.parametrize("meeting", [1, 2, 3])
def test_a_lattice_at_rest_has_its_density_everywhere(taichi, meeting):
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
def test_the_gradient_is_that_of_the_share(taichi, meeting):
    points = np.random.default_rng(3).uniform(-0.1 * H, 0.9 * H, (200, 3))
    step = 1e-3 * H
    exact = share(points, WALLS[:meeting])[:, :3]
    for axis in range(3):
        ahead, behind = points.copy(), points.copy()
        ahead[:, axis] += step
        behind[:, axis] -= step
        difference = share(ahead, WALLS[:meeting])[:, 3] - share(behind, WALLS[:meeting])[:, 3]
        np.testing.assert_allclose(difference / (2 * step), exact[:, axis], atol=1e-3 * np.abs(exact).max())


@pytest.fixture
def made_good(taichi):
    """B a for accelerations [m/s^2] at points [m], both of shape [n, 3]."""
    from sim.device.arrays import Vec4Array, numpy_real, real, vec4
    from sim.device.compiler import ti
    from sim.fluid.boundary.half_space import along_faces
    from sim.fluid.layout import Walls

    @ti.kernel
    def ask(count: ti.i32, walls: Walls, inverse_h: real, a: Vec4Array):
        for i in range(count):
            a[i].xyz = along_faces(i, a[i].xyz, walls, inverse_h)

    def at(points, accelerations, planes):
        count = len(points)
        a = ti.ndarray(vec4, count)
        a.from_numpy(np.column_stack((accelerations, np.zeros(count))).astype(numpy_real))
        ask(count, faces_at(points, planes).lists, 1 / H, a)
        return a.to_numpy()[:, :3]

    return at


@pytest.mark.parametrize("meeting", [1, 2])
def test_a_pressure_gradient_along_walls_accelerates_all_alike(made_good, meeting):
    """-sum_j (q_i + q_j) grad W for q = z, in the layers next to the walls and inside."""
    axis = (np.arange(4) + 0.5) * SPACING
    points = np.array(list(itertools.product(axis, repeat=3)))
    around = lattice(SPACING, H)
    pull = -cubic_slope_host(np.linalg.norm(around, axis=1), H) * around[:, 2] ** 2
    there = np.all((points[:, None, :meeting] + around[None, :, :meeting]) > 0, axis=2)
    lacking = np.zeros_like(points)
    lacking[:, 2] = there @ pull / pull.sum()
    assert lacking[:, 2].min() < 0.86
    # Only the first layer is calibrated, and what two walls have in common is the product of what they are alone.
    np.testing.assert_allclose(made_good(points, lacking, WALLS[:meeting])[:, 2], 1.0, atol=0.01)


def test_what_is_made_good_is_symmetric_between_walls_at_any_angle(made_good):
    planes = np.array([[0, 1, 0, 0], [np.sin(0.7), np.cos(0.7), 0, 0.001], [0.48, 0.6, 0.64, 0]])
    at = np.full((3, 3), 0.4 * SPACING)
    matrix = made_good(at, np.eye(3), planes)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-6)
    assert np.linalg.eigvalsh(matrix).min() >= 1 - 1e-6
