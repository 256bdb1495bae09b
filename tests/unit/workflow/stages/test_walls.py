"""Water fills its tank to the walls: volume, edges, normals; and which walls a scene has to its end."""

from __future__ import annotations

import numpy as np
import pytest

from sim.bodies.wall import Wall
from sim.spec import SimulationSpec
from tests.support.fluid.lattices import lattice
from tests.support.meshes import open_edges
from workflow.stages.surface.mesh import Surface
from workflow.stages.surface.spec import ReconstructSpec, SurfaceSpec
from workflow.stages.surface.standing import standing_walls
from workflow.stages.surface.surface import reconstruct
from workflow.stages.surface.walls import BEHIND, continued

RADIUS = 0.02
SPACING = 2 * RADIUS
COUNTS = (24, 10, 16)
LENGTH, HEIGHT, DEPTH = (SPACING * count for count in COUNTS)
TANK = tuple(
    Wall(normal=normal, offset=offset)
    for normal, offset in (
        ((1, 0, 0), 0),
        ((-1, 0, 0), -LENGTH),
        ((0, 1, 0), 0),
        ((0, 0, 1), 0),
        ((0, 0, -1), -DEPTH),
    )
)
ABOVE_TOP = 0.1 * RADIUS
"""How far the free surface may be from half a spacing above the particles: a twentieth of the spacing."""


def pool() -> np.ndarray:
    """Fluid that fills a tank to HEIGHT, not quite in order, float32, shape [n, 3]."""
    points = SPACING * lattice(*COUNTS) + SPACING / 2
    return (points + np.random.default_rng(0).normal(0, 0.03 * SPACING, points.shape)).astype(np.float32)


def surface(points: np.ndarray, velocities: np.ndarray | None = None, walls: tuple[Wall, ...] = TANK) -> Surface:
    """As the grid makes it: brought to its volume, a surface would make up for what walls lack. Spray, which walls keep
    in front of them, has tests of its own."""
    still = np.zeros_like(points) if velocities is None else velocities
    settings = SurfaceSpec(volume=False, spray=1)
    return reconstruct(points, still, ReconstructSpec(particle_radius=RADIUS, walls=walls, surface=settings))


def test_a_tank_is_full_to_its_edges():
    """Its volume is that of its particles but for the free surface; round edges lack ten times that."""
    points = pool()
    full = len(points) * SPACING**3
    assert surface(points).volume == pytest.approx(full, rel=ABOVE_TOP / HEIGHT)
    assert surface(points, walls=()).volume < full * (1 - 4 * ABOVE_TOP / HEIGHT)


def test_it_reaches_every_corner_of_the_floor_and_no_vertex_is_behind_a_wall():
    vertices = surface(pool()).vertices
    for x in (0.0, LENGTH):
        for z in (0.0, DEPTH):
            assert np.linalg.norm(vertices - [x, 0, z], axis=1).min() < 1e-6
    assert (vertices.min(axis=0) >= -1e-7).all()
    assert (vertices.max(axis=0) <= np.array([LENGTH, HEIGHT + RADIUS, DEPTH]) * (1 + 1e-6)).all()


def test_the_free_surface_meets_the_wall_at_its_height():
    vertices = surface(pool()).vertices
    at_wall = vertices[(vertices[:, 0] < 1e-6) & (np.abs(vertices[:, 2] - DEPTH / 2) < 3 * SPACING)]
    assert at_wall[:, 1].max() == pytest.approx(HEIGHT, abs=2 * ABOVE_TOP)


def test_it_is_closed_and_its_normals_look_into_the_walls():
    found = surface(pool())
    assert open_edges(found.triangles) == 0
    floor = (found.vertices[:, 1] < 1e-7) & (np.abs(found.vertices[:, 0] - LENGTH / 2) < LENGTH / 3)
    assert floor.sum() > 100
    inner = floor & (np.abs(found.vertices[:, 2] - DEPTH / 2) < DEPTH / 3)
    np.testing.assert_array_equal(found.normals[inner], np.broadcast_to([0, -1, 0], (inner.sum(), 3)))
    assert np.linalg.norm(found.normals, axis=1) == pytest.approx(1.0, abs=1e-5)


def test_the_fluid_moves_along_the_walls_there():
    points = pool()
    velocities = np.tile(np.float32([1.5, -2.0, 0.5]), (len(points), 1))
    found = surface(points, velocities)
    floor = found.vertices[:, 1] < 1e-7
    assert (np.abs(found.velocities[floor][:, 1]) < 1e-6).all()
    away = floor & (np.abs(found.vertices[:, 0] - LENGTH / 2) < LENGTH / 4)
    away &= np.abs(found.vertices[:, 2] - DEPTH / 2) < DEPTH / 4
    assert found.velocities[away][:, 0] == pytest.approx(1.5, rel=1e-4)


def test_an_oblique_wall():
    """The pool, all of it turned, has the volume of the pool."""
    normal = np.array([1.0, 2.0, 2.0]) / 3
    turn = np.eye(3) - 2 * np.outer(normal, normal)
    walls = tuple(Wall(normal=tuple(turn @ np.array(wall.normal)), offset=wall.offset) for wall in TANK)
    points = pool()
    turned = (points @ turn.T).astype(np.float32)
    assert surface(turned, walls=walls).volume == pytest.approx(surface(points).volume, rel=ABOVE_TOP / HEIGHT)


def block(height: float) -> np.ndarray:
    """27 particles around the middle of the tank, the lowest at a height in spacings."""
    return (SPACING * lattice(3, 3, 3) + np.array([LENGTH / 2, height * SPACING, DEPTH / 2])).astype(np.float32)


def test_what_touches_no_wall_stays_as_it_is_to_the_last_bit():
    cloud, _ = continued((block(1.1), np.zeros_like(block(1.1))), SPACING, TANK)
    np.testing.assert_array_equal(cloud, block(1.1))
    free, near = surface(block(1.1), walls=()), surface(block(1.1))
    # splashsurf adds up normals in any order
    np.testing.assert_allclose(near.normals, free.normals, atol=1e-6)
    np.testing.assert_allclose(near.vertices, free.vertices, atol=1e-6)
    assert near.vertices[:, 1].min() > 0
    lower = surface(block(0.5))
    assert (lower.vertices[:, 1] == 0).sum() > 50


def test_lone_drops_and_threads_are_not_drawn_to_a_wall():
    """No more of them than what is behind the wall is changed."""
    thread = SPACING * lattice(12, 1, 1) + np.array([0.2, 0.5 * SPACING, 0.3])
    drop = np.array([[0.8, 0.5 * SPACING, 0.3]])
    spray = np.concatenate([thread, drop]).astype(np.float32)
    free, near = surface(spray, walls=()), surface(spray)
    np.testing.assert_allclose(near.vertices, np.maximum(free.vertices, [-1, 0, -1]), atol=1e-6)


def test_particles_go_on_in_line_behind_a_wall():
    points = block(0.3)
    velocities = np.tile(np.float32([1, -2, 3]), (27, 1))
    cloud, speed = continued((points, velocities), SPACING, TANK[2:3])
    np.testing.assert_array_equal(cloud[:27], points)
    lowest = points[points[:, 1] < SPACING]
    assert len(cloud) == 27 + 9 * BEHIND
    for layer in range(BEHIND):
        copies = cloud[27 + 9 * layer :][:9]
        assert copies[:, 1] == pytest.approx(np.full(9, -(0.3 + layer) * SPACING), rel=1e-5)
        np.testing.assert_array_equal(copies[:, [0, 2]], lowest[:, [0, 2]])
    np.testing.assert_array_equal(speed[27:], np.broadcast_to(np.float32([1, 0, 3]), (9 * BEHIND, 3)))


def scene(*events: dict) -> SimulationSpec:
    return SimulationSpec.model_validate(
        {
            "containers": {"tank": {"type": "box", "size": [1, 1, 1], "open": ["top", "right"]}},
            "rigid": {"bodies": {"gate": {"shape": {"type": "plane", "normal": [-1, 0, 0]}, "position": [0.2, 0, 0]}}},
            "events": events,
        }
    )


def test_walls_that_an_event_removes_or_moves_do_not_count():
    assert [wall.normal for wall in standing_walls(scene())] == [
        (-1, 0, 0),
        (1, 0, 0),
        (0, 1, 0),
        (0, 0, 1),
        (0, 0, -1),
    ]
    assert len(standing_walls(scene({"at": 0.5, "remove": ["gate"]}))) == 4
    assert len(standing_walls(scene({"at": 0.5, "set": {"rigid.bodies.gate.friction": 0.1}}))) == 5
    moved = standing_walls(scene({"at": 0.5, "set": {"containers.tank.size": [2, 1, 1]}}))
    assert [wall.normal for wall in moved] == [(-1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1)]
