"""The sparse grid of distances around meshes, against closed forms for a box and a sphere."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import trimesh

from sim.geometry.distance.narrow_band import BLOCK, narrow_band

CELL, REACH = 0.02, 0.08


def places(band):
    """Where the nodes are [m], shape [n, 3]."""
    points = np.full((len(band.nodes), 3), np.nan)
    for block in np.argwhere(band.table >= 0):
        row = band.table[tuple(block)] * BLOCK**3
        inner = np.array(list(itertools.product(range(BLOCK), repeat=3)))
        points[row : row + BLOCK**3] = band.low + band.cell * (BLOCK * block + inner)
    assert np.isfinite(points).all()
    return points


def box_distance(points, half):
    """Signed, exact outside and inside."""
    beyond = np.abs(points) - half
    return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)


def test_nodes_know_how_far_a_box_is():
    half = np.array([0.1, 0.15, 0.2])
    band = narrow_band(trimesh.creation.box(2 * half), CELL, REACH)
    points = places(band)
    distance = box_distance(points, half)
    np.testing.assert_allclose(band.nodes[:, 3], distance, atol=1e-7)
    step = 1e-6
    slope = [box_distance(points + step * e, half) - box_distance(points - step * e, half) for e in np.eye(3)]
    outside = distance > 2 * step
    np.testing.assert_allclose(band.nodes[outside, :3], np.transpose(slope)[outside] / (2 * step), atol=1e-4)


def ball(radius):
    """A sphere of triangles finer than a cell, and how far they are within it at most [m]."""
    mesh = trimesh.creation.icosphere(5, radius)
    return mesh, radius - np.abs((mesh.triangles_center * mesh.face_normals).sum(axis=1)).min()


def test_nodes_know_how_far_a_sphere_is():
    mesh, within = ball(0.2)
    band = narrow_band(mesh, CELL, REACH)
    r = np.linalg.norm(places(band), axis=1)
    assert (band.nodes[:, 3] >= r - 0.2 - 1e-7).all()
    assert (band.nodes[:, 3] <= r - 0.2 + within + 1e-7).all()


@pytest.mark.parametrize("shape", ["box", "sphere", "plate"])
def test_all_cells_near_the_surface_have_their_nodes(shape, random):
    """A place within the reach lies among eight nodes that are there."""
    mesh = {
        "box": trimesh.creation.box([0.2, 0.3, 0.4]),
        "sphere": ball(0.2)[0],
        "plate": trimesh.creation.box([0.4, 0.002, 0.4]),
    }[shape]
    band = narrow_band(mesh, CELL, REACH)
    on, _ = trimesh.sample.sample_surface(mesh, 5000, seed=1)
    way = random.normal(size=(5000, 3))
    near = on + REACH * random.uniform(size=(5000, 1)) * way / np.linalg.norm(way, axis=1, keepdims=True)
    corner = np.floor((near - band.low) / band.cell).astype(int)
    for step in itertools.product((0, 1), repeat=3):
        block = (corner + step) // BLOCK
        assert (block >= 0).all()
        assert (block < band.table.shape).all()
        assert (band.table[tuple(block.T)] >= 0).all()


def inner(band, points):
    """Nodes of which all six neighbours are there: where differences are central."""
    known = {tuple(place) for place in np.rint((points - band.low) / band.cell).astype(int)}
    ways = np.vstack((np.eye(3, dtype=int), -np.eye(3, dtype=int)))
    index = np.rint((points - band.low) / band.cell).astype(int)
    return np.array([all(tuple(place + way) in known for way in ways) for place in index])


def test_the_curvature_around_a_sphere_is_one_over_the_radius():
    """Half of central differences of r: off by cell^2 / 24 times the sum of fourth derivatives of r, at most 6 / r^3;
    and by 3 / cell^2 times the depth of the triangles within the sphere, as that differs from node to node."""
    mesh, within = ball(0.2)
    band = narrow_band(mesh, CELL, REACH)
    points = places(band)
    r = np.linalg.norm(points, axis=1)
    central = inner(band, points) & (np.abs(r - 0.2) < REACH)
    off = band.curvature - 1 / r
    bound = CELL**2 / 8 / r**3 + 3 * within / CELL**2
    assert central.sum() > 1000
    assert (np.abs(off) < bound)[central].all()
    assert abs((r * off)[central].mean()) < 0.03


def test_a_thin_wall_is_flat(random):
    """The distance has a kink between its sides; the curvature is none of it."""
    half = np.array([0.2, 0.1 * CELL, 0.2])
    band = narrow_band(trimesh.creation.box(2 * half), CELL, REACH)
    points = places(band)
    above = (np.abs(points[:, [0, 2]]) < 0.2 - 1.5 * CELL).all(axis=1)
    assert above.sum() > 1000
    np.testing.assert_allclose(band.curvature[above], 0, atol=1e-4)
