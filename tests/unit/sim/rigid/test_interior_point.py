"""Contacts that are solved at once: a block on legs, one that slides, and contacts that do not go together."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from sim.rigid.dynamics.interior_point import impulses

MASS, SIDE, G, DT = 2.0, 0.3, 9.81, 0.01
INERTIA = MASS * SIDE**2 / 6
ERROR = 1e-10


def legs(*places: tuple[float, float], speed: tuple[float, float, float] = (0, 0, 0)) -> tuple[csr_matrix, np.ndarray]:
    """A cube on a floor that it touches in places below its centre, after a step of free fall: mobility and relative
    velocities, along the normal and across."""
    rows = []
    for x, z in places:
        arm = np.array([x, -SIDE / 2, z])
        for axis in ([0, 1, 0], [1, 0, 0], [0, 0, 1]):
            rows.append(np.concatenate((axis, np.cross(arm, axis))))
    jacobian = np.array(rows, dtype=float)
    weight = np.diag([1 / MASS] * 3 + [1 / INERTIA] * 3)
    motion = np.array([speed[0], speed[1] - G * DT, speed[2], 0, 0, 0])
    return csr_matrix(jacobian @ weight @ jacobian.T), (jacobian @ motion).reshape(-1, 3)


CORNERS = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_four_legs_bear_a_quarter_each(friction):
    """Three would do; in the middle of all impulses that hold the cube, all are the same."""
    mobility, velocity = legs(*CORNERS)
    found, off = impulses(mobility, velocity, np.full(4, friction), ERROR)
    assert off <= ERROR
    assert found[:, 0] == pytest.approx(np.full(4, MASS * G * DT / 4), rel=1e-3)
    assert np.abs(found[:, 1:]).max() < 1e-3 * MASS * G * DT


def test_what_slides_is_slowed_by_mu_times_its_weight():
    mobility, velocity = legs(*CORNERS, speed=(3.0, 0, 4.0))
    mu = 0.2
    found, off = impulses(mobility, velocity, np.full(4, mu), ERROR)
    assert off <= 5.0 * np.sqrt(np.finfo(float).eps)
    assert found.sum(axis=0) == pytest.approx(MASS * G * DT * np.array([1, -0.6 * mu, -0.8 * mu]), rel=1e-6)


def test_what_leaves_the_floor_is_not_held():
    mobility, velocity = legs(*CORNERS, speed=(1.0, 2 * G * DT, 0))
    found, off = impulses(mobility, velocity, np.full(4, 0.5), ERROR)
    assert off <= ERROR
    assert np.abs(found).max() < 1e-6 * MASS * G * DT


def test_a_leg_that_is_a_little_too_long():
    """By 1e-6 m/s: the cube stands on it and on the two beside it, or sweeps would shift impulses for ever."""
    mobility, velocity = legs(*CORNERS)
    velocity[0, 0] -= 1e-6
    found, off = impulses(mobility, velocity, np.full(4, 0.5), ERROR)
    assert off <= ERROR
    left = (mobility @ found.ravel()).reshape(-1, 3)[:, 0] + velocity[:, 0]
    assert left.min() > -ERROR
    assert found[:, 0].sum() == pytest.approx(MASS * G * DT + MASS * 0.25e-6, rel=1e-4)


def test_contacts_that_can_not_all_be_met_end_with_finite_impulses():
    """Floor and ceiling come nearer to each other by 1 mm/s: half of that is left at either."""
    velocity = np.zeros((2, 3))
    jacobian = np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1], [0, -1, 0], [1, 0, 0], [0, 0, 1]], dtype=float)
    mobility = csr_matrix(jacobian @ jacobian.T / MASS)
    velocity[:, 0] = -1e-3
    found, off = impulses(mobility, velocity, np.full(2, 0.3), ERROR)
    assert np.isfinite(found).all()
    assert off == pytest.approx(1e-3, rel=0.5)
