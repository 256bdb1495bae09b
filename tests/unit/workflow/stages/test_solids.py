"""Water ends flush with the bodies and vessels that it touches: nothing between them, nothing behind them."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from sim.bodies.filmed import Body
from sim.bodies.wall import Wall
from sim.spec import SimulationSpec
from workflow.stages.surface.mesh import Surface
from workflow.stages.surface.solids import SUNK, Solid, contacts
from workflow.stages.surface.spec import ReconstructSpec, SurfaceSpec
from workflow.stages.surface.standing import standing_vessels
from workflow.stages.surface.surface import reconstruct

SPACING = 0.02
FLUSH = 0.1 * SPACING
"""How far vertices beside a body may be inside it: between particles, planes at their feet are that far from it."""


def lattice(low: tuple[float, ...], high: tuple[float, ...]) -> np.ndarray:
    """Particles in a box [spacings], half a spacing from its sides [m]."""
    axes = [np.arange(a + 0.5, b) for a, b in zip(low, high, strict=True)]
    return SPACING * np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)


def placed(mesh: trimesh.Trimesh, turn: np.ndarray | None = None, *, closed: bool = True) -> Solid:
    return Solid(Body(mesh, closed=closed), np.zeros(3), np.eye(3) if turn is None else turn)


def made(points: np.ndarray, *solids: Solid, walls: tuple[Wall, ...] = (), **settings: object) -> Surface:
    spec = ReconstructSpec(particle_radius=SPACING / 2, walls=walls, surface=SurfaceSpec(**settings))
    points = points.astype(np.float32)
    return reconstruct(points, np.zeros_like(points), spec, solids=solids)


def cup(thickness: float, radius: float = 8.0, height: float = 12.0) -> trimesh.Trimesh:
    """A cup with a floor [spacings], whose inside begins at 0."""
    outer = radius + thickness
    profile = [(0, -thickness), (outer, -thickness), (outer, height), (radius, height), (radius, 0), (0, 0)]
    mesh = trimesh.creation.revolve(SPACING * np.array(profile), sections=96)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    return mesh


def in_cup(depth: float = 6.0, radius: float = 8.0) -> np.ndarray:
    """Particles in rings, the outermost half a spacing from the wall."""
    rings = []
    for away in np.arange(radius - 0.5, 0.4, -1.0):
        angle = 2 * np.pi * np.arange(round(2 * np.pi * away)) / round(2 * np.pi * away)
        rings.append(away * np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], axis=1))
    ring = np.concatenate(rings)
    return SPACING * np.concatenate([ring + np.array([0, height, 0]) for height in np.arange(0.5, depth)])


def gap(found: Surface, depth: float) -> np.ndarray:
    """Distances [m] from points of the inside of a cup, below the water's level, to the surface of the water."""
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    height = SPACING * np.linspace(0.5, depth - 1, 8)
    around = np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], axis=1)
    wall = 8 * SPACING * around[None] + height[:, None, None] * np.array([0, 1, 0])
    water = trimesh.Trimesh(found.vertices, found.triangles, process=False)
    return trimesh.proximity.closest_point(water, wall.reshape(-1, 3))[1]


@pytest.mark.parametrize("thickness", [4.0, 1.0, 0.5])
def test_water_in_a_cup_touches_it_and_stays_inside(thickness: float) -> None:
    mesh, points = cup(thickness), in_cup()
    found = made(points, placed(mesh))
    assert gap(found, 6.0).max() < 0.1 * SPACING
    away = np.linalg.norm(found.vertices[:, [0, 2]], axis=1)
    assert away.max() < 8 * SPACING + FLUSH
    assert found.vertices[:, 1].min() > -FLUSH
    assert trimesh.Trimesh(found.vertices, found.triangles, process=False).is_watertight


def test_a_vessel_without_an_inside_holds_water_likewise() -> None:
    """As the inner surfaces of containers are: open, in one layer."""
    profile = SPACING * np.array([(8, 12), (8, 0), (0, 0)], float)
    mesh = trimesh.creation.revolve(profile, sections=96)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    found = made(in_cup(), placed(mesh, closed=False))
    assert gap(found, 6.0).max() < 0.1 * SPACING
    assert np.linalg.norm(found.vertices[:, [0, 2]], axis=1).max() < 8 * SPACING + FLUSH


def test_a_ball_in_a_pool_has_no_air_around_it() -> None:
    points = lattice((-12, 0, -12), (12, 14, 12))
    center, radius = np.array([0, 12 * SPACING, 0]), 5 * SPACING
    ball = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    ball.apply_translation(center)
    points = points[np.linalg.norm(points - center, axis=1) > radius + 0.45 * SPACING]
    found = made(points, placed(ball))
    depth = np.linalg.norm(found.vertices - center, axis=1) - radius
    low = found.vertices[:, 1] < 11 * SPACING
    near = low & (depth < 0.9 * SPACING)
    assert near.sum() > 500
    assert np.abs(depth[near]).max() < FLUSH
    outwards = (center - found.vertices[near]) / np.linalg.norm(center - found.vertices[near], axis=1)[:, None]
    assert np.einsum("ij,ij->i", outwards, found.normals[near]).min() > 0.95


def film(pitch: float = 1.5) -> np.ndarray:
    """One layer, half a spacing above 0, stretched."""
    points = pitch * lattice((0, 0, 0), (16, 1, 16))
    points += np.random.default_rng(3).normal(0, 0.12 * SPACING, points.shape)
    points[:, 1] = SPACING / 2
    return points


def test_a_film_on_a_table_lies_on_it_and_has_its_volume() -> None:
    table = trimesh.creation.box([3, 1, 3])
    table.apply_translation([0, -0.5, 0])
    found = made(film(), placed(table))
    assert found.volume == pytest.approx(len(film()) * SPACING**3, rel=0.01)
    on = np.abs(found.vertices[:, 1] + SUNK * SPACING) < 1e-3 * SPACING
    assert on.mean() > 0.45
    assert (found.normals[on, 1] < -0.99).mean() > 0.99
    assert found.vertices[:, 1].min() > -FLUSH


@pytest.mark.parametrize("thickness", [6.0, 3.0, 1.0])
def test_water_on_both_sides_of_a_plate_is_not_in_it(thickness: float) -> None:
    """As in a tank with a wall across, or around a pillar that is as thick as fluid goes on from both sides."""
    high = np.concatenate([lattice((-8, thickness, -8), (8, 6 + thickness, 8)), lattice((-8, -6, -8), (8, 0, 8))])
    plate = trimesh.creation.box([3, thickness * SPACING, 3])
    plate.apply_translation([0, thickness * SPACING / 2, 0])
    water = trimesh.Trimesh(*(getattr(made(high, placed(plate)), name) for name in ("vertices", "triangles")))
    x, y, z = np.meshgrid(np.linspace(-6, 6, 9), np.linspace(0.2, 0.8, 4) * thickness, np.linspace(-6, 6, 9))
    middle = SPACING * np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    assert water.volume == pytest.approx(len(high) * SPACING**3, rel=0.01)
    assert not water.contains(middle).any()


def test_a_body_may_be_turned_and_moved() -> None:
    turn = Rotation.from_euler("xyz", [0.3, 1.0, -2.0]).as_matrix()
    mesh, points = cup(1.0), in_cup()
    straight = made(points, placed(mesh))
    turned = made(points @ turn.T, placed(mesh, turn))
    assert turned.volume == pytest.approx(straight.volume, rel=2e-3)
    local = turned.vertices @ turn
    assert np.linalg.norm(local[:, [0, 2]], axis=1).max() < 8 * SPACING + FLUSH
    assert local[:, 1].min() > -FLUSH


def test_spray_and_water_elsewhere_know_nothing_of_a_body() -> None:
    table = trimesh.creation.box([3, 1, 3])
    table.apply_translation([0, -0.5, 0])
    drops = lattice((0, 0, 0), (20, 1, 20))[::7] * np.array([3, 1, 3])
    far = lattice((0, 3, 0), (6, 9, 6))
    for points in (drops, far):
        alone, beside = made(points), made(points, placed(table))
        assert np.array_equal(alone.vertices, beside.vertices)
        np.testing.assert_allclose(alone.normals, beside.normals, atol=1e-6)


def test_what_got_into_a_body_does_not_turn_it_inside_out() -> None:
    table = trimesh.creation.box([3, 1, 3])
    table.apply_translation([0, -0.5, 0])
    got_in = SPACING * np.array([[4.5, -0.3, 4.5], [5.5, -0.3, 4.5], [4.5, -0.3, 5.5]])
    points = np.concatenate([lattice((0, 0, 0), (8, 4, 8)), got_in])
    touch = contacts(points, [placed(table)], SPACING)
    assert len(touch.particle) == 64
    assert touch.particle.max() < len(points) - len(got_in)
    assert made(points, placed(table)).vertices[:, 1].min() > -SPACING


def test_vessels_that_stand_all_the_time_are_told() -> None:
    mesh = {"type": "mesh", "file": "cup.ply"}
    spec = {
        "containers": {
            "kept": {"type": "mesh", "shape": mesh},
            "lost": {"type": "mesh", "shape": mesh},
            "box": {"type": "box", "size": [1, 1, 1]},
        },
        "fluid": {"particle_radius": 0.01, "bodies": {"water": {"shape": {"type": "sphere", "radius": 0.2}}}},
        "events": [{"at": 0.5, "remove": ["lost"]}],
    }
    assert standing_vessels(SimulationSpec.model_validate(spec)) == ("kept",)
