"""Shapes filled with particles: n = V / d^3, and lattices where they fit."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from scene.settings import Refused
from sim.geometry.filling import fill
from sim.geometry.shapes import place
from sim.geometry.spec import Box, Capsule, Cylinder, MeshFile, Placement, Plane, Sheet, Sphere, Torus

TURNED = Placement(position=(1, -2, 3), rotation=({"axis": (1, 2, 3), "angle": 40},), scale=1.5)
BUNNY = MeshFile(type="mesh", file="pymeshfix:examples/StanfordBunny.ply", up="z", size=1)


def placed(shape, placement=None):
    return place(shape, placement or Placement(), Path())


def closest_pair(points):
    return cKDTree(points).query(points, k=2)[0][:, 1].min()


def test_box_of_whole_spacings_is_filled_exactly():
    """n = a b c / d^3, first layer d/2 from every face; 0.1 is not a binary fraction."""
    points = fill(placed(Box(type="box", size=(0.3, 0.7, 1.1)), Placement(position=(5, 6, 7))), 0.1)
    assert len(points) == 3 * 7 * 11
    np.testing.assert_allclose(points.min(axis=0), [5 - 0.1, 6 - 0.3, 7 - 0.5], atol=1e-14)
    np.testing.assert_allclose(points.max(axis=0), [5 + 0.1, 6 + 0.3, 7 + 0.5], atol=1e-14)
    np.testing.assert_allclose(cKDTree(points).query(points, k=2)[0][:, 1], 0.1, rtol=1e-12)


def test_box_keeps_its_lattice_when_turned_and_scaled():
    solid = placed(Box(type="box", size=(0.3, 0.7, 1.1)), TURNED)
    points = fill(solid, 0.15)
    assert len(points) == 3 * 7 * 11
    np.testing.assert_allclose(solid.signed_distance(points).max(), -0.075, rtol=1e-9)


@pytest.mark.parametrize(
    "size",
    [(0.39, 0.39, 0.39), (4, 0.198, 4), (0.5, 6.7, 0.5), (3.34, 2, 2), (3.35, 3.333, 2.999), (0.66996, 0.5, 0.5)],
)
def test_box_of_any_size_has_its_volume(size):
    """Rows differ by one particle at most, so that no step is far from d."""
    solid = placed(Box(type="box", size=size))
    points = fill(solid, 0.1)
    assert abs(len(points) - solid.volume / 0.1**3) <= 1
    assert closest_pair(points) > 0.09
    assert solid.signed_distance(points).max() < -0.045
    np.testing.assert_allclose(points.mean(axis=0), 0, atol=0.005)


@pytest.mark.parametrize("thickness", [0.01, 0.04, 0.09, 0.13, 0.15, 0.17])
def test_plate_thinner_than_two_particles_has_its_volume(thickness):
    """One loose layer in its middle below a spacing; two that are near each other at 1.5, but not much below 0.8 d."""
    solid = placed(Box(type="box", size=(2, thickness, 3)))
    points = fill(solid, 0.1)
    assert abs(len(points) - solid.volume / 0.1**3) <= 1
    assert closest_pair(points) > 0.078
    if thickness < 0.1:
        np.testing.assert_array_equal(points[:, 1], 0)
        assert closest_pair(points) > 0.099


SHAPES = [
    Sphere(type="sphere", radius=0.5),
    Cylinder(type="cylinder", radius=0.5, height=1.03),
    Cylinder(type="cylinder", radius=1, height=0.03),
    Capsule(type="capsule", radius=0.4, height=0.5),
    Torus(type="torus", radius=0.5, tube_radius=0.2),
    Torus(type="torus", radius=1, tube_radius=0.03),
    BUNNY,
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.type)
@pytest.mark.parametrize("spacing", [0.1, 0.05, 0.025])
def test_any_shape_has_its_volume(shape, spacing):
    solid = placed(shape)
    points = fill(solid, spacing)
    assert abs(len(points) - solid.volume / spacing**3) <= 1
    assert solid.contains(points).all()
    assert closest_pair(points) > 0.8 * spacing


@pytest.mark.parametrize("radius", [0.05, 0.062, 0.07, 0.09, 0.1, 0.123, 0.15, 0.2, 0.23, 0.3])
def test_small_drop_has_its_volume(radius):
    solid = placed(Sphere(type="sphere", radius=radius))
    points = fill(solid, 0.1)
    assert abs(len(points) - solid.volume / 0.1**3) <= 0.5
    assert np.abs(points.mean(axis=0)).max() < 0.25 * radius


def test_cylinder_has_layers_along_its_axis():
    solid = placed(Cylinder(type="cylinder", radius=1, height=1.24), TURNED)
    points = solid.pose.to_local(fill(solid, 0.15))
    layers, counts = np.unique(points[:, 1].round(9), return_counts=True)
    np.testing.assert_allclose(np.diff(layers), 1.24 / 12)
    assert np.ptp(counts) <= 1


def test_order_is_that_of_the_lattice():
    points = fill(placed(Sphere(type="sphere", radius=0.5)), 0.1)
    np.testing.assert_array_equal(points, points[np.lexsort(points.T[::-1])])
    np.testing.assert_array_equal(points, fill(placed(Sphere(type="sphere", radius=0.5)), 0.1))


@pytest.mark.parametrize(
    ("shape", "spacing", "says"),
    [
        (Plane(type="plane"), 0.1, "no volume"),
        (Sheet(type="sheet", size=(1, 1)), 0.1, "no volume"),
        (Box(type="box", size=(0.1, 0.1, 0.04)), 0.1, "less than half a particle"),
        (Box(type="box", size=(1, 1, 1)), 1e-4, "more than memory holds"),
        (Sphere(type="sphere", radius=1), 1e-4, "more than memory holds"),
    ],
)
def test_what_can_not_be_filled_is_refused(shape, spacing, says):
    with pytest.raises(Refused, match=says) as refused:
        fill(placed(shape), spacing)
    assert refused.value.remedy
