"""Thin sheets are whole and flat for the surface; drops, threads and bulk are left as they are."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from sim.bodies.wall import Wall
from sim.geometry.thinning import first_come
from tests.support.fluid import lattices
from workflow.stages.surface.layers import whole_layers
from workflow.stages.surface.spec import Layers, ReconstructSpec
from workflow.stages.surface.surface import reconstruct

SPACING = 0.02
ROOM = 0.72 * SPACING
"""That new particles keep from all others [m]."""
SHARE = 0.9
"""Of the way to the mean of what is around."""
SUPPORT = 2.0
"""Of that mean, in spacings."""


def lattice(*counts: int, spacing: float = SPACING) -> np.ndarray:
    return (spacing * lattices.lattice(*counts)).astype(np.float32)


def still(points: np.ndarray) -> np.ndarray:
    return np.zeros_like(points)


def wholed(points: np.ndarray, **settings: float) -> np.ndarray:
    return whole_layers(points, still(points), SPACING, Layers(**settings))[0]


def ball() -> np.ndarray:
    points = lattice(21, 21, 21) - 10 * SPACING
    return points[np.linalg.norm(points, axis=1) < 9.3 * SPACING]


def thread() -> np.ndarray:
    return lattice(30, 1, 1, spacing=1.3 * SPACING)


def drops() -> np.ndarray:
    return lattice(4, 4, 4, spacing=5 * SPACING)


@pytest.mark.parametrize(
    "cloud", [ball(), lattice(12, 9, 10), lattice(12, 2, 12), thread(), drops(), np.empty((0, 3), np.float32)]
)
def test_what_is_no_sheet_stays_as_it_is(cloud: np.ndarray) -> None:
    assert np.array_equal(wholed(cloud), cloud)


def surface_of(points: np.ndarray, **layers: object) -> trimesh.Trimesh:
    spec = ReconstructSpec.model_validate({"particle_radius": SPACING / 2, "surface": {"layers": layers}})
    found = reconstruct(points, still(points), spec)
    return trimesh.Trimesh(found.vertices, found.triangles, process=False)


@pytest.mark.parametrize("stretch", [1.7, 1.8])
def test_a_stretched_sheet_is_one_body_without_holes(stretch: float) -> None:
    """A slab without holes has the topology of a ball: V - E + F = 2. Each hole takes 2 off, each body adds 2."""
    points = lattice(16, 1, 12, spacing=stretch * SPACING)
    assert surface_of(points, enabled=False).euler_number != 2
    whole = surface_of(points)
    assert whole.is_watertight
    assert whole.euler_number == 2
    assert whole.body_count == 1


def test_a_puddle_of_one_and_two_layers_keeps_its_volume() -> None:
    generator = np.random.default_rng(4)
    points = np.concatenate([lattice(12, 1, 12), lattice(6, 1, 12) + np.float32([0, SPACING, 0])])
    points += generator.normal(0, 0.1 * SPACING, points.shape).astype(np.float32)
    assert surface_of(points).volume == pytest.approx(len(points) * SPACING**3, rel=0.1)


def test_a_gap_wider_than_the_reach_stays_open() -> None:
    sheet = lattice(12, 1, 12)
    apart = sheet + np.float32([11 * SPACING + 3 * SPACING, 0, 0])
    both = np.concatenate([sheet, apart])
    assert len(wholed(both, reach=2.6)) == len(both)
    assert len(wholed(both, reach=3.2)) > len(both)


def film(pitch: float, seed: int = 6) -> np.ndarray:
    """One layer, half a spacing above the floor, as it is when it has spread: some gaps are wider than most."""
    points = lattice(24, 1, 24, spacing=pitch * SPACING)
    points += np.random.default_rng(seed).normal(0, 0.35 * SPACING, points.shape).astype(np.float32)
    points[:, 1] = SPACING / 2
    return points


def test_a_film_on_a_floor_has_no_holes_where_a_sheet_in_the_air_has() -> None:
    """Inside, that is: the topology of a ball, but for what its rim makes."""
    points = film(1.6)
    floor = (Wall(normal=(0, 1, 0), offset=0.0),)
    free, on_floor = (whole_layers(points, still(points), SPACING, Layers(), walls)[0] for walls in ((), floor))
    inner = np.stack(np.meshgrid(*[np.linspace(0.1, 0.6, 120)] * 2), axis=-1).reshape(-1, 2)
    bare = [(KDTree(cloud[:, [0, 2]]).query(inner)[0] > 1.1 * SPACING).sum() for cloud in (points, free, on_floor)]
    assert bare[0] > bare[1] > 0
    assert bare[2] == 0


def test_a_film_is_filled_whatever_flies_above_it() -> None:
    points = film(1.6)
    above = points[::7] + np.float32([0, 2.2 * SPACING, 0])
    both = np.concatenate([points, above])
    floor = (Wall(normal=(0, 1, 0), offset=0.0),)
    alone, with_spray = (whole_layers(cloud, still(cloud), SPACING, Layers(), floor)[0] for cloud in (points, both))
    low = with_spray[len(both) :]
    assert (low[:, 1] < SPACING).sum() >= len(alone) - len(points)


def test_heights_go_by_the_weights_of_the_mean() -> None:
    """Independent heights of deviation s become s sqrt((1 - c + c w0)^2 + sum (c wj)^2), with c the share of the way
    and w the weights of the mean (Yu & Turk 2013, equations 6 and 11)."""
    points = lattice(60, 1, 60)
    heights = np.random.default_rng(1).normal(0, 0.02 * SPACING, len(points)).astype(np.float32)
    points[:, 1] = heights
    result = wholed(points)
    assert len(result) == len(points)
    steps = np.stack(np.meshgrid(np.arange(-2, 3), np.arange(-2, 3)), axis=-1).reshape(-1, 2)
    weights = np.maximum(0, 1 - (np.linalg.norm(steps, axis=1) / SUPPORT) ** 3)
    weights /= weights.sum()
    own = weights.max()
    expected = np.sqrt((1 - SHARE + SHARE * own) ** 2 + SHARE**2 * (np.sum(weights**2) - own**2))
    inner = ((points[:, [0, 2]] > 3 * SPACING) & (points[:, [0, 2]] < 56 * SPACING)).all(axis=1)
    assert result[inner, 1].std() / heights[inner].std() == pytest.approx(expected, rel=0.05)


def test_sheets_may_lie_in_any_way() -> None:
    generator = np.random.default_rng(2)
    points = lattice(14, 1, 14, spacing=1.4 * SPACING)
    points += generator.normal(0, 0.05 * SPACING, points.shape).astype(np.float32)
    turn = Rotation.from_euler("xyz", [0.4, -1.1, 2.0]).as_matrix().astype(np.float32)
    turned = wholed(points @ turn.T + np.float32([1, -2, 0.5]))
    expected = wholed(points) @ turn.T + np.float32([1, -2, 0.5])
    assert turned.shape == expected.shape
    apart, same = KDTree(turned).query(expected)
    assert len(np.unique(same)) == len(turned)
    assert apart.max() < 1e-4 * SPACING


def test_new_particles_go_with_those_on_both_sides() -> None:
    """The velocity of a sheet that is pulled apart evenly is linear, and so it is between its particles."""
    points = lattice(10, 1, 10, spacing=1.5 * SPACING)
    rate = 3.0
    result, velocities = whole_layers(points, rate * points, SPACING, Layers())
    new = slice(len(points), None)
    assert len(result[new]) > 0
    centers = velocities[new] / rate
    gaps, _ = KDTree(points).query(centers)
    assert np.abs(centers[:, 1]).max() == 0
    assert gaps.min() > ROOM


def test_no_two_new_particles_crowd() -> None:
    points = lattice(10, 1, 10, spacing=1.9 * SPACING)
    result, middle = whole_layers(points, points, SPACING, Layers())
    assert len(result) > len(points)
    assert len(KDTree(middle[len(points) :]).query_pairs(0.999 * ROOM)) == 0


@pytest.mark.parametrize("number", [0, 400, 6000])
def test_the_first_of_a_crowd_stays(number: int) -> None:
    points = np.random.default_rng(3).random((number, 3))
    distance = 0.15
    kept: list[int] = []
    for index, point in enumerate(points):
        if np.all(np.linalg.norm(point - points[kept], axis=1) > distance):
            kept.append(index)
    assert first_come(points, distance).tolist() == kept
