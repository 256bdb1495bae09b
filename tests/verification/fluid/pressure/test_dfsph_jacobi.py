"""DFSPH by the published iteration: what holds for every solver, and what its two solves promise.

Bounds are those of the other solvers, or follow from `density_error` and `divergence_error`.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from sim.fluid.kernel import cubic_slope_host, particle_mass
from sim.fluid.pressure.dfsph_jacobi import FEW, growth
from tests.support.fluid.solvers import probe, run, steps
from tests.support.particles import positions, read_frame, velocities
from tests.verification.fluid.pressure import test_solvers_motion as motion
from tests.verification.fluid.pressure import test_solvers_wave as wave

RHO, G = 1000.0, 9.81
ERROR = 1e-4
"""Of densities and of the divergence, as by default."""
JACOBI = {"solver": "dfsph", "dfsph": {"iteration": "jacobi"}}


def test_a_collision_keeps_the_momentum(tmp_path):
    motion.check_momentum(motion.collision(tmp_path, "dfsph", dfsph=JACOBI["dfsph"]))


def test_what_falls_freely_does_so_exactly(tmp_path):
    motion.check_fall(tmp_path, motion.fall(tmp_path, "dfsph", 2e-3, dfsph=JACOBI["dfsph"]))


def compression_rates(points: np.ndarray, speeds: np.ndarray, spacing: float) -> np.ndarray:
    """D rho / D t = sum_j m (v_i - v_j).grad W_ij [kg/(m^3 s)] of particles without solids, shape [n]; less than
    nothing for those with less than 20 neighbours, as 33.5 d^3 have room in the support."""
    h = 2 * spacing
    apart = points[:, None] - points[None]
    r = np.linalg.norm(apart, axis=2)
    slope = np.where(r < h, cubic_slope_host(r, h), 0.0)
    rates = particle_mass(spacing, h, RHO) * (slope * (apart * (speeds[:, None] - speeds[None])).sum(axis=2)).sum(
        axis=1
    )
    neighbours = (r < h).sum(axis=1) - 1
    return np.where(neighbours * 3 / (32 * np.pi) >= FEW, rates, -1.0)


def test_velocities_after_a_step_compress_no_more_than_asked(tmp_path):
    """Two drops in the middle of their collision: the mean over all particles of dt D rho / D t, where it compresses,
    is under `divergence_error`, to what single precision makes of a sum over neighbours."""
    out = motion.collision(tmp_path, "dfsph", dfsph=JACOBI["dfsph"])
    table = steps(out)
    assert table["divergence_iterations"].max() > 3, "nothing had to be solved"
    for frame in (2, 3, 4):
        particles = read_frame(out, frame)
        rates = compression_rates(positions(particles).astype(float), velocities(particles).astype(float), 0.024)
        dt = table["dt"][np.searchsorted(table["time"], frame / 20 - 1e-9)]
        left = dt * np.maximum(rates, 0).mean() / RHO
        print(f"frame {frame}: {left:.2e}")
        assert left < 1.02 * ERROR


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    """A shaft of 10 x 10 particles, 10 deep, that stands on a plate, after two seconds."""
    size, d = 0.4, 0.04
    plate = {"shape": {"type": "box", "size": [size + 8 * d, 0.2, size + 8 * d]}, "position": [0, -0.1, 0]}
    water = {"shape": {"type": "box", "size": [size] * 3}, "position": [0, size / 2, 0]}
    spec = {
        "fps": 10,
        "containers": {"shaft": {"type": "box", "size": [size, 2, size], "position": [0, -0.2, 0], "open": ["bottom"]}},
        "fluid": JACOBI | {"particle_radius": d / 2, "bodies": {"water": water}},
        "rigid": {"bodies": {"floor": plate}},
        "probes": {
            "push": {"type": "force", "body": "floor", "rate": 1e6},
            "bottom": {"type": "pressure", "at": [0, d / 2, 0], "rate": 1e6},
        },
    }
    return run(spec, tmp_path_factory.mktemp("pool"), 20), size, d


def test_a_pool_keeps_its_density(pool):
    """Within `density_error` in the mean of a step, and what is of second order in the displacement by pressure, g dt^2
    over the spacing, which the equations leave; the first step begins without pressures, and may be capped."""
    out, size, d = pool
    table = steps(out)
    second_order = (G * table["dt"].max() ** 2 / d) ** 2
    late = table["time"] > 1
    print(f"{table['density_error_avg'][late].mean():.2e}, second order {second_order:.1e}")
    assert table["density_error_avg"][late].mean() < ERROR + second_order
    assert json.loads((out / "summary.json").read_text())["counts"]["steps_capped"] <= 1
    # The surface stays where it is: half a particle is what a lattice may give way by.
    assert 2 * positions(read_frame(out, 20))[:, 1].mean() == pytest.approx(size, abs=d / 2)


def test_the_pressure_of_a_pool(pool):
    """rho g times the depth at the bottom, within that of a spacing; on the floor 2 %, as for every solver."""
    out, size, d = pool
    dt, late = steps(out)["dt"], steps(out)["time"] > 1
    _, push = probe(out, "push", "force_y")
    floor = -(dt * push[1:])[late].sum() / dt[late].sum() / size**2
    _, bottom = probe(out, "bottom")
    found = (dt * bottom[1:])[late].sum() / dt[late].sum()
    print(f"floor {floor / (RHO * G * size) - 1:+.2%}, bottom {found / (RHO * G * (size - d / 2)) - 1:+.2%}")
    assert floor == pytest.approx(RHO * G * size, rel=0.02)
    assert found == pytest.approx(RHO * G * (size - d / 2), abs=RHO * G * d)


def test_water_follows_a_floor_that_goes_down(tmp_path):
    """A plate that begins at once to go down, slower than what falls: the water on it has its velocity half a second
    later, within what falls in a step; were it not for the plate's velocity, the divergence solve would hold it up."""
    d, speed = 0.04, 0.1
    plate = {"shape": {"type": "box", "size": [1, 0.2, 1]}, "position": [0, -0.1, 0]}
    plate |= {"motion": "prescribed", "velocity": [0, -speed, 0]}
    water = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.1, 0]}
    shaft = {"type": "box", "size": [0.2, 2, 0.2], "position": [0, -0.3, 0], "open": ["bottom"]}
    fluid = JACOBI | {"particle_radius": d / 2, "bodies": {"water": water}}
    spec = {"fps": 20, "containers": {"shaft": shaft}, "fluid": fluid, "rigid": {"bodies": {"plate": plate}}}
    out = run(spec, tmp_path, 20)
    down = [velocities(read_frame(out, frame))[:, 1].mean() for frame in range(10, 21)]
    print(f"{np.mean(down):+.4f} m/s")
    assert np.mean(down) == pytest.approx(-speed, abs=G * steps(out)["dt"].max())
    height = positions(read_frame(out, 20))[:, 1].mean() + speed * 1.0
    assert height == pytest.approx(0.1, abs=d / 4)


@pytest.mark.slow
def test_the_period_of_the_standing_wave(tmp_path):
    wave.check(tmp_path, "dfsph", 10, 2, dfsph=JACOBI["dfsph"])


@pytest.mark.parametrize("support_ratio", [3, 4, 5, 6])
def test_the_growth_is_that_of_the_matrix(support_ratio):
    """The greatest eigenvalue of J J^T over its diagonal, J the gradients of densities by positions, for a lattice that
    is periodic: 8 particles along each axis, so that the wave numbers of it are among those of all."""
    d, cells = 1.0, 8
    h = support_ratio * d / 2
    axis = np.arange(cells) * d
    points = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    apart = points[:, None] - points[None]
    apart -= cells * d * np.round(apart / (cells * d))
    r = np.linalg.norm(apart, axis=2)
    gradient = np.where(r < h, cubic_slope_host(r, h), 0.0)[:, :, None] * apart
    jacobian = -gradient
    jacobian[np.arange(len(points)), np.arange(len(points))] = gradient.sum(axis=1)
    jacobian = jacobian.reshape(len(points), -1)
    diagonal = np.square(jacobian[0]).sum()
    largest = np.linalg.eigvalsh(jacobian @ jacobian.T)[-1] / diagonal
    assert largest <= growth(d, h) * (1 + 1e-9)
    assert largest == pytest.approx(growth(d, h), rel=0.1)
