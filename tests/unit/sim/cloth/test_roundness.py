"""Normals of round solids that are made of triangles, and the edges that stay edges."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sim.cloth.contact.detection.roundness import Roundness
from sim.cloth.contact.detection.search import EDGE, POINT

CLOTH = 3
"""Points of the cloth, which come first."""
AWAY = np.arange(15.0).reshape(5, 3)[:CLOTH]


def solid(mesh: trimesh.Trimesh) -> tuple[Roundness, np.ndarray, np.ndarray]:
    """Its normals, all places, and the triangles among them."""
    places = np.concatenate([AWAY, mesh.vertices])
    triangles = np.asarray(mesh.faces) + CLOTH
    return Roundness(triangles, places, CLOTH), places, triangles


def on_triangles(triangles: np.ndarray, shares: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Contacts of a point of the cloth with every triangle, at these shares of its corners: keys and weights."""
    ones = np.ones((len(triangles), 1), int)
    key = np.hstack([POINT * ones, 0 * ones, triangles])
    return key, np.hstack([ones, np.broadcast_to(-np.array(shares), triangles.shape)])


def facets(places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    return trimesh.Trimesh(places, triangles, process=False).face_normals


def test_a_ball_faces_away_from_its_centre():
    """Normals interpolated between corners are right to the square of the angle between triangles, and those of
    triangles to the first order. They turn with the ball."""
    ball = trimesh.creation.icosphere(3, 1.0)
    found, places, triangles = solid(ball)
    turned = places.copy()
    turned[CLOTH:] = places[CLOTH:] @ trimesh.transformations.rotation_matrix(0.7, [1, 2, 3])[:3, :3].T + [1, 0, 0]
    key, weight = on_triangles(triangles, (0.7, 0.2, 0.1))
    there = np.einsum("tc,tcj->tj", -weight[:, 1:], turned[key[:, 2:]]) - [1, 0, 0]
    radial = there / np.linalg.norm(there, axis=1, keepdims=True)
    flat = facets(turned, triangles)
    normal, real = found.normals(key, weight, flat, turned, turned)
    angle = ball.face_adjacency_angles.max()
    assert real.all()
    assert np.arccos(np.clip((normal * radial).sum(axis=1), -1, 1)).max() < angle**2
    assert np.arccos((flat * radial).sum(axis=1)).max() > angle / 4


def test_a_box_keeps_its_faces_and_edges():
    found, places, triangles = solid(trimesh.creation.box((1, 2, 3)))
    assert found.flat
    askew = np.broadcast_to(np.array([1.0, 1.0, 0.0]) / np.sqrt(2), (len(triangles), 3))
    on_edge = on_triangles(triangles, (0.5, 0.5, 0.0))
    _, real = found.normals(*on_edge, askew, places, places)
    normal, _ = found.normals(*on_triangles(triangles, (1.0, 0.0, 0.0)), askew, places, places)
    assert normal == pytest.approx(askew)
    assert real[: len(triangles)].any()


def test_a_can_is_round_at_its_side_and_has_rims():
    """The edges along its side are no edges; a contact at a rim keeps its direction, on a lid that of the lid."""
    can = trimesh.creation.cylinder(1.0, 2.0, sections=32)
    found, places, triangles = solid(can)
    lids = np.abs(facets(places, triangles)[:, 2]) > 0.5
    normal, _ = found.normals(*on_triangles(triangles, (0.4, 0.3, 0.3)), facets(places, triangles), places, places)
    assert normal[lids] == pytest.approx(facets(places, triangles)[lids])
    assert np.abs(normal[~lids][:, 2]).max() < 1e-9

    edges = can.face_adjacency_edges + CLOTH
    along = np.ptp(places[edges][..., 2], axis=1) > 1.9
    ones = np.ones((len(edges), 1), int)
    key = np.hstack([EDGE * ones, 0 * ones, 1 * ones, edges])
    weight = np.broadcast_to([0.5, 0.5, -0.5, -0.5], (len(edges), 4))
    middle = places[edges].mean(axis=1)
    aside = middle + np.array([0.0, 0.0, 0.3])
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    normal, _ = found.normals(key, weight, aside, places, places)
    radial = middle * [1, 1, 0] / np.linalg.norm(middle[:, :2], axis=1, keepdims=True)
    upright = along & (np.ptp(places[edges][..., :2], axis=1).max(axis=1) < 1e-9)
    rim = can.face_adjacency_angles > 1.0
    assert upright.sum() == 32
    assert rim.sum() == 64
    assert normal[upright] == pytest.approx(radial[upright], abs=1e-9)
    assert normal[rim] == pytest.approx(aside[rim])


def test_what_stands_on_a_round_surface_touches_it_with_its_foot():
    """A corner of a ball and a triangle of cloth that is seen edge on are no contact."""
    found, places, triangles = solid(trimesh.creation.icosphere(2, 1.0))
    corner = int(triangles[0, 0])
    outward = places[corner] / np.linalg.norm(places[corner])
    across = np.cross(outward, [0.3, 0.5, 0.8])
    across /= np.linalg.norm(across)
    key, weight = np.array([[POINT, corner, 0, 1, 2]]), np.array([[1.0, -0.3, -0.3, -0.4]])
    for normal, touches in ((-outward, True), (across, False)):
        facing, real = found.normals(key, weight, normal[None], places, places)
        assert real[0] == touches
        if touches:
            assert facing[0] == pytest.approx(-outward, abs=1e-2)
