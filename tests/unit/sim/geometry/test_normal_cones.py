"""Which ways surfaces face: facets of what is round as what they touch, faces of a box as they are."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sim.geometry.meshes import normal_cones


@pytest.mark.parametrize("halvings", [3, 4])
def test_facets_of_a_ball_are_taken_for_round(halvings):
    ball = trimesh.creation.icosphere(subdivisions=halvings)
    for cones in (normal_cones.smooth(ball), normal_cones.of_vertices(ball)):
        assert normal_cones.rounded(cones)[:, 3] == pytest.approx(np.cos(normal_cones.ROUND))


def test_faces_and_corners_of_a_box_are_not():
    box = trimesh.creation.box((1, 2, 3))
    for cones in (normal_cones.smooth(box), normal_cones.of_vertices(box)):
        assert np.array_equal(normal_cones.rounded(cones), cones)
