"""Near pairs against all pairs."""

from __future__ import annotations

import numpy as np

from sim.neighbors.sweep_and_prune import near_pairs, near_planes


def test_the_pairs_are_those_whose_boxes_overlap():
    random = np.random.default_rng(3)
    low = random.uniform(0, 4, (80, 3))
    high = low + random.uniform(0, 1, (80, 3))
    free = random.uniform(size=80) < 0.7
    expected = {
        (a, b)
        for a in range(80)
        for b in range(a + 1, 80)
        if (free[a] or free[b]) and (low[a] <= high[b]).all() and (low[b] <= high[a]).all()
    }
    found = near_pairs(low, high, free)
    assert len(found) == len(expected) > 20
    assert set(map(tuple, found.tolist())) == expected


def test_no_bodies_are_no_pairs():
    assert near_pairs(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, bool)).shape == (0, 2)


def test_planes_are_near_where_a_box_reaches_them():
    middle = np.array([[0, 0.6, 0], [0, 0.4, 0], [0, -3, 0]])
    half = np.full((3, 3), 0.5)
    free = np.array([True, True, False])
    normals, offsets = np.array([[0, 1.0, 0], [1.0, 0, 0]]), np.array([0.0, -2.0])
    assert near_planes(middle, half, free, normals, offsets).tolist() == [[1, 0]]
