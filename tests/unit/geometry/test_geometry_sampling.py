"""Surfaces that are evenly covered by samples."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from sim.geometry.sampling import sample_surface
from sim.geometry.shapes import place
from sim.geometry.spec import Box, Cylinder, MeshFile, Placement, Plane, Sheet, Sphere, Torus
from sim.settings import Refused

TURNED = Placement(position=(1, -2, 3), rotation=({"axis": (1, 2, 3), "angle": 40},), scale=1.5)
BUNNY = MeshFile(type="mesh", file="pymeshfix:examples/StanfordBunny.ply", up="z", size=1)


def placed(shape, placement=None):
    return place(shape, placement or Placement(), Path())


def boundary_volumes(points, spacing):
    """V_b = 1 / sum_k W(x_b - x_k) over all samples, itself included; cubic spline, support h = 2 spacing:
    W = 8 / (pi h^3) (6 (q^3 - q^2) + 1 for q <= 1/2, 2 (1 - q)^3 for q <= 1)."""
    h = 2 * spacing
    pairs = cKDTree(points).sparse_distance_matrix(cKDTree(points), h, output_type="coo_matrix")
    q = pairs.data / h
    kernel = 8 / (np.pi * h**3) * np.where(q <= 0.5, 6 * (q**3 - q**2) + 1, 2 * (1 - q) ** 3)
    return 1 / np.bincount(pairs.row, weights=kernel, minlength=len(points))


def check_evenness(points, mesh, spacing, *, scatter):
    nearest = cKDTree(points).query(points, k=2)[0][:, 1]
    assert nearest.min() > 0.7 * spacing
    assert nearest.max() < 1.25 * spacing
    anywhere, _ = trimesh.sample.sample_surface(mesh, 50_000, seed=3)
    assert cKDTree(points).query(anywhere)[0].max() < 1.0 * spacing
    assert len(points) * spacing**2 == pytest.approx(mesh.area, rel=0.06)
    volumes = boundary_volumes(points, spacing)
    assert volumes.std() / volumes.mean() < scatter
    # A flat square lattice of the spacing has 1.40 spacing^3.
    assert volumes.mean() == pytest.approx(1.40 * spacing**3, rel=0.1)


@pytest.mark.parametrize(
    "shape",
    [
        Sphere(type="sphere", radius=1),
        Cylinder(type="cylinder", radius=0.5, height=1),
        Torus(type="torus", radius=1, tube_radius=0.3),
    ],
    ids=lambda shape: shape.type,
)
def test_curved_surface_is_covered_evenly(shape):
    solid = placed(shape)
    points = sample_surface(solid, 0.05)
    check_evenness(points, solid.mesh, 0.05, scatter=0.07)
    assert np.abs(solid.signed_distance(points)).max() < 0.003


def test_bunny_is_covered_evenly():
    solid = placed(BUNNY)
    spacing = 0.02
    points = sample_surface(solid, spacing)
    check_evenness(points, solid.mesh, spacing, scatter=0.08)
    assert np.abs(solid.signed_distance(points)).max() < 1e-9


@pytest.mark.parametrize("as_mesh", [False, True])
def test_box_is_covered_to_its_edges_and_corners(as_mesh):
    solid = placed(Box(type="box", size=(0.5, 0.7, 0.9)), TURNED)
    points = sample_surface(solid.mesh if as_mesh else solid, 0.075)
    assert np.abs(solid.signed_distance(points)).max() < 1e-12
    assert cKDTree(points).query(solid.mesh.vertices)[0].max() < 1e-12
    a, b = solid.mesh.vertices[solid.mesh.edges_unique].transpose(1, 0, 2)
    lengths = np.linalg.norm(b - a, axis=1)
    straight = np.isclose(lengths[:, None], 1.5 * np.array([0.5, 0.7, 0.9])).any(axis=1)
    along = np.linspace(0, 1, 50)[:, None, None]
    edges = (a[straight] + along * (b - a)[straight]).reshape(-1, 3)
    assert cKDTree(points).query(edges)[0].max() < 0.61 * 0.075
    if not as_mesh:
        # Surface points of an n x m x k grid of cells.
        n, m, k = 10, 14, 18
        assert len(points) == (n + 1) * (m + 1) * (k + 1) - (n - 1) * (m - 1) * (k - 1)
        volumes = boundary_volumes(points, 0.075)
        assert volumes.std() / volumes.mean() < 0.03


@pytest.mark.parametrize("as_mesh", [False, True])
def test_sheet_is_one_layer(as_mesh):
    solid = placed(Sheet(type="sheet", size=(1, 0.6)))
    points = sample_surface(solid.mesh if as_mesh else solid, 0.05)
    assert np.abs(points[:, 1]).max() < 1e-12
    if not as_mesh:
        assert len(points) == 21 * 13
    np.testing.assert_allclose(points.min(axis=0), [-0.5, 0, -0.3], atol=1e-12)
    np.testing.assert_allclose(points.max(axis=0), [0.5, 0, 0.3], atol=1e-12)
    nearest = cKDTree(points).query(points, k=2)[0][:, 1]
    assert nearest.min() > 0.7 * 0.05
    assert nearest.max() < 1.2 * 0.05


def test_samples_are_the_same_every_time(tmp_path, monkeypatch):
    solid = placed(Torus(type="torus", radius=1, tube_radius=0.3))
    first = sample_surface(solid, 0.1)
    monkeypatch.setenv("TIDEMILL_CACHE", str(tmp_path))
    np.testing.assert_array_equal(first, sample_surface(solid, 0.1))


def test_surface_smaller_than_the_spacing_has_samples():
    assert len(sample_surface(placed(Sphere(type="sphere", radius=0.01)), 0.1)) >= 1
    assert len(sample_surface(placed(Box(type="box", size=(0.01, 0.01, 0.01))), 0.1)) == 8


def test_what_can_not_be_covered_is_refused():
    with pytest.raises(Refused, match="no end"):
        sample_surface(placed(Plane(type="plane")), 0.1)
    with pytest.raises(Refused, match="more than memory holds"):
        sample_surface(placed(Sphere(type="sphere", radius=1)), 1e-5)
