"""Lone drops are balls of their particle's volume, wherever they are and whatever the grid is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scene.presets import PRESETS
from sim.bodies.wall import Wall
from tests.support.fluid.lattices import lattice
from tests.support.meshes import open_edges
from workflow.stages.surface.mesh import Surface
from workflow.stages.surface.spec import ReconstructSpec
from workflow.stages.surface.surface import reconstruct

RADIUS = 0.02
SPACING = 2 * RADIUS
BALL = np.cbrt(3 / (4 * np.pi)) * SPACING
"""Radius of a ball that has the volume of a particle [m]."""
FACETED = 1 + 0.62**2 / 6
"""Corners of a ball of 80 triangles, over the radius of a round one, at most: so far are the middles of triangles, with
edges of up to 0.62, below the sphere through their corners."""


def surface(points: np.ndarray, velocities: np.ndarray | None = None, **settings: Any) -> Surface:
    points = np.asarray(points, np.float32)
    still = np.zeros_like(points) if velocities is None else np.asarray(velocities, np.float32)
    return reconstruct(points, still, ReconstructSpec.model_validate({"particle_radius": RADIUS, **settings}))


BALLS = {"spray": 1}
"""One drop of each particle."""


def scattered(count: int) -> np.ndarray:
    """Particles more than three spacings from one another, nowhere in particular on a grid; shape [count^3, 3]."""
    cells = lattice(count, count, count)
    return SPACING * (4 * cells + np.random.default_rng(1).random(cells.shape))


@pytest.mark.parametrize("quality", ["draft", "standard", "final"])
def test_spray_has_the_volume_of_its_particles(quality):
    points = scattered(4)
    found = surface(points, surface=PRESETS[quality]["surface"])
    assert found.volume == pytest.approx(len(points) * SPACING**3, rel=1e-5)


def test_each_drop_is_round_closed_and_moves_as_its_particle():
    points = scattered(2)
    velocities = np.arange(3 * len(points)).reshape(-1, 3)
    found = surface(points, velocities, surface=BALLS)
    assert open_edges(found.triangles) == 0
    assert len(found.vertices) - len(found.triangles) * 3 // 2 + len(found.triangles) == 2 * len(points)
    away = np.linalg.norm(found.vertices[:, None] - points, axis=2)
    own = away.argmin(axis=1)
    assert (np.bincount(own, minlength=len(points)) == len(found.vertices) // len(points)).all()
    np.testing.assert_array_equal(found.velocities, velocities[own])
    arm = found.vertices - points[own]
    length = np.linalg.norm(arm, axis=1)
    assert length.max() - length.min() < 1e-6
    assert BALL < length.mean() < FACETED * BALL
    np.testing.assert_allclose(found.normals, arm / length[:, None], atol=1e-5)


def drops_of(found: Surface, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Middles [m], shape [k, count, 3], and volumes [m^3], shape [k, count]: first come the largest of each, of 42
    vertices and 80 triangles, then all others, of 12 and 20."""
    number = len(found.vertices) // (42 + 12 * (count - 1))
    sizes = [(number, 42, 80, 1), (number * (count - 1), 12, 20, count - 1)]
    middles, volumes, vertex, triangle = [], [], 0, 0
    for balls, corners, faces, each in sizes:
        place = found.vertices[vertex : vertex + balls * corners].reshape(balls, corners, 3).astype(np.float64)
        middle = place.mean(axis=1)
        of = found.vertices[found.triangles[triangle : triangle + balls * faces]].astype(np.float64)
        arms = of - np.repeat(middle, faces, axis=0)[:, None]
        middles.append(middle.reshape(number, each, 3))
        volumes.append((np.linalg.det(arms).reshape(balls, faces).sum(axis=1) / 6).reshape(number, each))
        vertex, triangle = vertex + balls * corners, triangle + balls * faces
    return np.concatenate(middles, axis=1), np.concatenate(volumes, axis=1)


@pytest.mark.parametrize("count", [2, 4, 9])
def test_spray_keeps_mass_and_centre_of_each_particle(count):
    points = scattered(2)
    middles, mass = drops_of(surface(points, surface={"spray": count}), count)
    assert middles.shape == (len(points), count, 3)
    np.testing.assert_allclose(mass.sum(axis=1), SPACING**3, rtol=1e-4)
    np.testing.assert_allclose(mass[:, 1:] / mass[:, :-1], 0.6, rtol=1e-3)
    center = np.einsum("ij,ijk->ik", mass, middles) / mass.sum(axis=1)[:, None]
    np.testing.assert_allclose(center, points, atol=1e-4 * SPACING)
    away = np.linalg.norm(middles - points[:, None], axis=2)
    assert away.mean() > 0.2 * SPACING and away.max() < 1.2 * SPACING


def test_a_particle_is_the_same_drops_in_all_frames():
    """Though others come before it, and wherever it has flown."""
    points, numbers = scattered(2).astype(np.float32), np.arange(8) + 2**31
    spec = ReconstructSpec(particle_radius=RADIUS)
    early, _ = drops_of(reconstruct(points, points, spec, numbers=numbers), 4)
    shift = np.float32([0.5, -1, 0.25])
    late, _ = drops_of(reconstruct(points[3:] + shift, points[3:], spec, numbers=numbers[3:]), 4)
    np.testing.assert_allclose(late - shift, early[3:], atol=1e-6)
    ways = (early - points[:, None])[:, 0]
    assert np.linalg.norm(ways[:, None] - ways, axis=2)[np.triu_indices(8, 1)].min() > 0.01 * SPACING


def test_no_drop_of_spray_is_gone_behind_a_wall():
    floor = Wall(normal=(0, 1, 0), offset=0)
    points = scattered(3) * np.array([1, 0, 1]) + np.array([0, 0.1 * SPACING, 0])
    points = np.unique(points.round(9), axis=0)[::9]
    found = surface(points, walls=[floor.model_dump()])
    assert found.volume == pytest.approx(len(points) * SPACING**3, rel=0.01)
    assert found.vertices[:, 1].min() == 0


def test_what_others_are_near_is_left_to_the_surface_of_all():
    """A pair within the kernel's reach of two spacings is one body; beyond it, it is two balls."""
    near, far = (surface(points_apart(1.9)), surface(points_apart(2.1)))
    assert near.volume != pytest.approx(2 * SPACING**3, rel=1e-4)
    assert far.volume == pytest.approx(2 * SPACING**3, rel=1e-5)


def points_apart(spacings: float) -> list[list[float]]:
    return [[0, 0, 0], [0, spacings * SPACING, 0]]


def test_a_short_kernel_makes_no_balls_that_overlap():
    """Two particles 1.2 spacings from one another are within the sum of the balls' radii, 1.3 spacings."""
    found = surface(points_apart(1.2), surface={"smoothing_length": 1.0})
    assert len(found.triangles) != 160


def test_a_drop_changes_nothing_of_the_water_below_it():
    block = SPACING * lattice(6, 6, 6)
    alone = surface(block)
    both = surface(np.concatenate([block, [[0.1, 1.0, 0.1]]]))
    count = len(alone.vertices)
    np.testing.assert_array_equal(both.vertices[:count], alone.vertices)
    np.testing.assert_array_equal(both.triangles[: len(alone.triangles)], alone.triangles)
    assert both.volume - alone.volume == pytest.approx(SPACING**3, rel=1e-3)
    assert open_edges(both.triangles) == 0


def test_a_drop_on_the_ground_is_flat_below():
    floor = Wall(normal=(0, 1, 0), offset=0)
    found = surface([[0, RADIUS, 0]], [[1, -2, 0]], walls=[floor.model_dump()], surface=BALLS)
    assert found.vertices[:, 1].min() == 0
    below = found.vertices[:, 1] == 0
    assert below.sum() >= 4
    np.testing.assert_array_equal(found.normals[below], np.broadcast_to([0, -1, 0], (below.sum(), 3)))
    np.testing.assert_array_equal(found.velocities[below], np.broadcast_to([1, 0, 0], (below.sum(), 3)))
    np.testing.assert_array_equal(found.velocities[~below], np.broadcast_to([1, -2, 0], ((~below).sum(), 3)))
    assert open_edges(found.triangles) == 0


def test_without_the_setting_drops_are_as_the_grid_makes_them():
    points = scattered(2)
    found = surface(points, surface=PRESETS["draft"]["surface"] | {"drops": False, "volume": False})
    assert found.volume < 0.95 * len(points) * SPACING**3
