"""The surface holds what its particles do: each piece of it, whatever they are like."""

from __future__ import annotations

import numpy as np
import pytest

from sim.bodies.wall import Wall
from workflow.stages.surface.boundary import Boundary
from workflow.stages.surface.mesh import Surface
from workflow.stages.surface.spec import ReconstructSpec, SurfaceSpec
from workflow.stages.surface.surface import reconstruct
from workflow.stages.surface.volume import FARTHEST, right_volume

SPACING = 0.1
FLOOR = Wall(normal=(0.0, 1.0, 0.0), offset=0.0)


def lattice(*sizes: int, pitch: tuple[float, float, float] = (1, 1, 1)) -> np.ndarray:
    """Particles in a box of so many along each axis, the lowest half a spacing above the floor [m]."""
    axes = [np.arange(float(size)) * step for size, step in zip(sizes, pitch, strict=True)]
    points = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    points[:, 1] += 0.5
    return (SPACING * points).astype(np.float32)


def disordered(points: np.ndarray, seed: int = 3) -> np.ndarray:
    moved = np.random.default_rng(seed).normal(0, 0.12 * SPACING, points.shape)
    return (points + moved).astype(np.float32)


def spray(count: int) -> np.ndarray:
    """Drops of one, two and three particles, here and there."""
    rng = np.random.default_rng(4)
    places = rng.permutation(1000)[:count]
    middle = np.stack([places // 100, places // 10 % 10, places % 10], axis=1) * 6 * SPACING
    members = [point + rng.normal(0, 0.35 * SPACING, (1 + k % 3, 3)) for k, point in enumerate(middle)]
    return np.concatenate(members).astype(np.float32) + np.float32(1.0)


def shell() -> np.ndarray:
    """A ball of water with a hole inside."""
    points = lattice(15, 15, 15)
    away = np.linalg.norm(points - points.mean(axis=0), axis=1) / SPACING
    return points[(away < 7) & (away > 3)]


CLOUDS = {
    "block": lattice(8, 8, 8),
    "layer": lattice(14, 1, 14),
    "stretched layer": disordered(lattice(14, 1, 14, pitch=(1.5, 1, 1.5))),
    "two layers": disordered(lattice(12, 2, 12)),
    "thread": lattice(20, 1, 1) + np.float32(1.0),
    "spray": spray(60),
    "hollow": shell() + np.float32(1.0),
    "block and spray": np.concatenate([lattice(8, 8, 8), spray(20) + np.float32(2.0)]),
}


def made(cloud: np.ndarray, walls: tuple[Wall, ...] = (), **settings) -> Surface:
    spec = ReconstructSpec(particle_radius=SPACING / 2, walls=walls, surface=SurfaceSpec(**settings))
    return reconstruct(cloud, np.zeros_like(cloud), spec)


def righted(surface: Surface, points: np.ndarray) -> Surface:
    """In the air."""
    return right_volume(
        surface, np.zeros(len(surface.vertices), bool), points, Boundary.around(points, (), (), SPACING)
    )


@pytest.mark.parametrize("walls", [(), (FLOOR,)], ids=["free", "on a floor"])
@pytest.mark.parametrize("cloud", CLOUDS)
def test_volume_is_that_of_the_particles(cloud, walls):
    points = CLOUDS[cloud]
    found = made(points, walls)
    assert found.volume == pytest.approx(len(points) * SPACING**3, rel=0.01)
    if walls:
        assert found.vertices[:, 1].min() >= 0.0


def test_a_stretched_layer_is_too_thick_otherwise():
    """By more than the bound that surfaces are asked to keep, or these tests would say nothing."""
    points = CLOUDS["stretched layer"]
    assert made(points, volume=False).volume > 1.3 * len(points) * SPACING**3


def test_water_on_a_floor_stays_on_it():
    found = made(CLOUDS["stretched layer"], (FLOOR,))
    below = found.vertices[found.normals[:, 1] < -0.9]
    assert len(below) > 100
    assert np.abs(below[:, 1]).max() < 1e-3 * SPACING


def test_a_lone_drop_on_a_floor_has_its_volume():
    drop = np.array([[0.0, 0.2 * SPACING, 0.0]], np.float32)
    assert made(drop, (FLOOR,)).volume == pytest.approx(SPACING**3, rel=0.01)
    assert made(drop, (FLOOR,), volume=False).volume < 0.97 * SPACING**3


def test_bulk_hardly_moves():
    points = lattice(20, 20, 20)
    before = made(points, volume=False)
    after = righted(before, points)
    moved = np.linalg.norm(after.vertices - before.vertices, axis=1) / SPACING
    assert np.median(moved) < 0.1


def test_nothing_moves_farther_than_half_a_layer():
    points = CLOUDS["block"]
    before = made(points, volume=False)
    few = righted(before, points[::7])
    assert np.linalg.norm(few.vertices - before.vertices, axis=1).max() <= 1.001 * FARTHEST * SPACING
    assert few.volume > 0


def test_a_hole_stays_a_hole():
    found = made(CLOUDS["hollow"])
    middle = CLOUDS["hollow"].mean(axis=0)
    away = np.linalg.norm(found.vertices - middle, axis=1) / SPACING
    assert (away < 4).sum() > 50
    assert away.min() > 1.5


def test_no_particles_no_surface():
    empty = np.empty((0, 3), np.float32)
    assert len(made(empty).triangles) == 0
