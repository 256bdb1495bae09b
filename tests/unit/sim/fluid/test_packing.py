"""Particles without a lattice are as many, as even, and the same in all directions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from sim.fluid.spec import Fluid, FluidBody
from sim.geometry.filling import fill
from sim.geometry.shapes import place

SPACING = 0.02


def solid(tmp_path, radius: float, at=(0.0, 0.0, 0.0)):
    body = FluidBody.model_validate({"shape": {"type": "sphere", "radius": radius}, "position": at})
    return place(body.shape, body, tmp_path)


def source(tmp_path, **body):
    from sim.fluid.seeding.sources import find_source

    return find_source("water", FluidBody.model_validate(body), Fluid(particle_radius=SPACING / 2), tmp_path, ())


def fourth_moment(points: np.ndarray) -> float:
    """Mean of n_x^4 + n_y^4 + n_z^4 over the directions n to neighbours nearer than 1.25 spacings: 3/5 where all
    directions are alike, 1 where all are those of the axes."""
    pairs = cKDTree(points).query_pairs(1.25 * SPACING, output_type="ndarray")
    apart = points[pairs[:, 0]] - points[pairs[:, 1]]
    return float(((apart / np.linalg.norm(apart, axis=1, keepdims=True)) ** 4).sum(axis=1).mean())


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    from sim.fluid.seeding.packing import fill_relaxed

    return fill_relaxed(solid(tmp_path_factory.mktemp("ball"), 10 * SPACING), SPACING)


def test_there_are_as_many_as_the_volume_holds(tmp_path, ball):
    assert len(ball) == len(fill(solid(tmp_path, 10 * SPACING), SPACING)) == round(4 / 3 * np.pi * 10**3)


def test_they_fill_the_shape_evenly(tmp_path, ball):
    """Densities by the kernel deep inside are those of the rest within 2 %, and no two are nearer than 0.7 d."""
    from sim.fluid.kernel import cubic_host, particle_mass

    h = 2 * SPACING
    deep = ball[np.linalg.norm(ball, axis=1) < 7 * SPACING]
    near = cKDTree(ball).query_ball_point(deep, h)
    mass = particle_mass(SPACING, h, 1.0)
    density = [
        mass * cubic_host(np.linalg.norm(ball[js] - x, axis=1), h).sum() for x, js in zip(deep, near, strict=True)
    ]
    assert np.abs(np.array(density) - 1).max() < 0.02
    assert cKDTree(ball).query(ball, k=2)[0][:, 1].min() > 0.7 * SPACING
    assert (np.linalg.norm(ball, axis=1) < 10 * SPACING + 0.2 * SPACING).all()


def test_no_direction_is_another(tmp_path, ball):
    """The fourth moment of a cube's number of directions is known to about 0.3 / sqrt(pairs)."""
    assert fourth_moment(fill(solid(tmp_path, 10 * SPACING), SPACING)) == pytest.approx(1.0)
    assert fourth_moment(ball) == pytest.approx(0.6, abs=0.02)


def test_a_shape_that_is_moved_takes_its_particles_along(tmp_path, ball):
    from sim.fluid.seeding.packing import fill_relaxed

    moved = fill_relaxed(solid(tmp_path, 10 * SPACING, (1.0, -2.0, 0.5)), SPACING)
    distance, _ = cKDTree(moved - [1.0, -2.0, 0.5]).query(ball)
    assert distance.max() < 1e-9


def test_a_few_particles_are_on_a_lattice(tmp_path):
    from sim.fluid.seeding.packing import fill_relaxed

    few = solid(tmp_path, 2.2 * SPACING)
    np.testing.assert_array_equal(fill_relaxed(few, SPACING), fill(few, SPACING))


@pytest.mark.parametrize(
    ("shape", "relaxed"),
    [
        ({"type": "sphere", "radius": 0.1}, True),
        ({"type": "capsule", "radius": 0.1, "height": 0.1}, True),
        ({"type": "box", "size": [0.2, 0.2, 0.2]}, False),
        ({"type": "cylinder", "radius": 0.1, "height": 0.2}, False),
    ],
)
def test_what_may_stand_in_a_tank_is_a_lattice_unless_asked_for(tmp_path, shape, relaxed):
    found = {packing: source(tmp_path, shape=shape, packing=packing).points for packing in ("lattice", "relaxed")}
    assert len(found["lattice"]) == len(found["relaxed"])
    chosen = source(tmp_path, shape=shape).points
    np.testing.assert_array_equal(chosen, found["relaxed" if relaxed else "lattice"])
    assert not np.array_equal(found["lattice"], found["relaxed"])
