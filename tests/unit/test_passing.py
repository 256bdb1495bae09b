"""The checker of what passes through cloth sees what passes, and nothing else."""

from __future__ import annotations

import numpy as np

from tests.support.passing import passed

TRIANGLES = np.array([[0, 1, 2], [3, 4, 5]])
LOW = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1]])
HIGH = np.array([[0.2, 0.5, 0.2], [0.4, 0.6, 0.2], [0.2, 0.7, 0.4]])


def _moved(shift) -> tuple[np.ndarray, np.ndarray]:
    before = np.concatenate([LOW, HIGH])
    return before, np.concatenate([LOW, HIGH + shift])


def test_a_corner_that_goes_through_a_triangle_is_seen():
    assert passed(*_moved([0, -0.55, 0]), TRIANGLES) >= 1


def test_edges_that_cross_are_seen():
    before = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, -1, 0], [0.5, 0.1, -0.5], [0.5, 0.1, 0.5], [0.5, 1, 0]])
    after = before - [0, 0.2, 0] * np.array([[0]] * 3 + [[1]] * 3)
    assert passed(before, after, TRIANGLES) >= 1


def test_what_comes_near_or_passes_beside_is_not():
    assert passed(*_moved([0, -0.49, 0]), TRIANGLES) == 0
    assert passed(*_moved([1.5, 0, 0]), TRIANGLES) == 0
    before, _ = _moved([0, 0, 0])
    assert passed(before + np.array([2, 0, 0]), before + np.array([2, -3, 0]), TRIANGLES) == 0


def test_pairs_without_cloth_do_not_count():
    before, after = _moved([0, -0.55, 0])
    assert passed(before, after, TRIANGLES, np.zeros(6, bool)) == 0
