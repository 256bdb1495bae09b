"""Closest points of a mesh where closed forms tell them."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sim.geometry.distance.closest_points import MeshDistance


@pytest.fixture
def cube():
    """Of edge 2 around the origin, with a triangle without area among its faces."""
    mesh = trimesh.creation.box((2, 2, 2))
    return trimesh.Trimesh(mesh.vertices, np.concatenate((mesh.faces, [[0, 0, 1]])), process=False)


def test_outside_a_cube_and_far_from_it(cube):
    points = np.random.default_rng(2).uniform(-30, 30, (500, 3))
    points = points[np.abs(points).max(axis=1) > 1]
    foot, distance, face = MeshDistance(cube).closest(points)
    assert foot == pytest.approx(np.clip(points, -1, 1), abs=1e-12)
    assert distance == pytest.approx(np.linalg.norm(points - np.clip(points, -1, 1), axis=1), rel=1e-12)
    assert ((face >= 0) & (face < len(cube.faces))).all()


def test_inside_a_cube(cube):
    points = np.random.default_rng(3).uniform(-0.99, 0.99, (200, 3))
    assert MeshDistance(cube).unsigned(points) == pytest.approx(1 - np.abs(points).max(axis=1), rel=1e-9)


def test_no_points_have_no_closest_ones(cube):
    foot, distance, face = MeshDistance(cube).closest(np.zeros((0, 3)))
    assert foot.shape == (0, 3) and distance.shape == face.shape == (0,)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_points_that_are_nowhere_are_refused(cube, value):
    with pytest.raises(ValueError, match="finite"):
        MeshDistance(cube).closest([[0, 0, 0], [value, 0, 0]])
