"""Which bodies hang together with one that stops, sets off or goes, and what contacts do to them."""

from __future__ import annotations

import numpy as np
import pytest

from sim.rigid.dynamics.release import borne_by, wrenches

CRATE, ON_IT, APART, LIFT, GROUND = range(5)
FREE = np.array([True, True, True, False, False])
PAIRS = np.array([[CRATE, LIFT], [CRATE, ON_IT], [APART, GROUND]])


@pytest.mark.parametrize(
    ("seeds", "expected"), [([LIFT], [CRATE, ON_IT]), ([GROUND], [APART]), ([ON_IT], [CRATE, ON_IT]), ([], [])]
)
def test_what_is_on_a_body_or_on_that_goes_with_it(seeds, expected):
    assert np.flatnonzero(borne_by(PAIRS, FREE, seeds)).tolist() == expected


def test_what_is_beside_on_the_same_ground_does_not():
    pairs = np.array([[CRATE, LIFT], [CRATE, GROUND], [APART, GROUND]])
    assert np.flatnonzero(borne_by(pairs, FREE, [LIFT])).tolist() == [CRATE]


def test_both_sides_of_a_contact_get_opposite_forces_and_their_moments():
    position = np.array([[0.0, 0, 0], [0, 2, 0]])
    force, turning = wrenches(np.array([[0, 1]]), np.array([[1.0, 1, 0]]), np.array([[0.0, -3, 0]]), position)
    assert force.tolist() == [[0, -3, 0], [0, 3, 0]]
    assert turning.tolist() == [[0, 0, -3], [0, 0, 3]]
    assert (turning + np.cross(position, force)).sum(axis=0).tolist() == [0, 0, 0]
