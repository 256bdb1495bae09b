"""Films between bodies and what they lie on: the areas that they act on, and the pressures in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from sim.coupling.fluid_rigid.lubrication import Lubrication, elements
from tests.support.floating import RHO, G, pool

SHAPES = {
    "box": trimesh.creation.box(extents=[0.2, 0.1, 0.3]),
    "plate": trimesh.creation.box(extents=[0.2, 0.005, 0.3]),
    "ball": trimesh.creation.icosphere(subdivisions=4, radius=0.1),
    "ring": trimesh.creation.torus(major_radius=0.1, minor_radius=0.03),
}


@pytest.mark.parametrize("name", SHAPES)
def test_areas_close_and_enclose_the_volume(name):
    """Over a closed surface int n dA = 0 and int x . n dA / 3 = V (Gauss)."""
    mesh = SHAPES[name]
    points, areas = elements(mesh, 0.02)
    assert np.abs(areas.sum(axis=0)).max() < 1e-12
    assert (points * areas).sum() / 3 == pytest.approx(mesh.volume, rel=0.03)
    assert len(points) < 6 * mesh.area / 0.02**2


@pytest.mark.parametrize("name", ["box", "plate"])
def test_elements_of_flat_faces_lie_on_them(name):
    mesh = SHAPES[name]
    points, areas = elements(mesh, 0.02)
    bottom = areas[:, 1] < -0.9 * np.linalg.norm(areas, axis=1)
    assert areas[bottom, 1].sum() == pytest.approx(-0.06, rel=1e-9)
    assert points[bottom, 1] == pytest.approx(np.full(bottom.sum(), mesh.bounds[0, 1]), abs=1e-12)


def lubrication_wrenches(body: dict, pressure, water: dict | None = None, raised: float = 0.0) -> np.ndarray:
    """Force [N] and torque [N m] of films on a body of a pool, or of other `water` in its tank.

    pressure: of particles [Pa], by their positions [m]; raised: by how much the body has come up [m] while particles
    stayed where they were.
    """
    from sim.device.compiler import ti
    from sim.run.stepping import Run
    from sim.spec import SimulationSpec

    body = {"motion": "dynamic", "density": 2000.0, **body}
    scene = pool("dfsph", 0.02, (0.6, 0.6, 0.5), 0.3, body)
    scene["fluid"]["bodies"]["water"] |= water or {}
    run = Run(SimulationSpec.model_validate(scene), Path(), threads=1, arch="cpu")
    run.start()
    system = run.world.fluid.system
    position = system.particles.numpy("position")
    world = position[:, :3] + run.world.origin
    position[:, 3] = pressure(world) / RHO**2
    system.particles.position.from_numpy(np.resize(position, (system.particles.capacity, 4)))
    solid = run.world.obstacles.placed[0].solid
    pivot = run.world.rigid.position[0]
    now = pivot - run.world.origin + raised * np.array([0.0, 1.0, 0.0])
    still = np.concatenate((np.eye(3).ravel(), now, np.zeros(6)))
    film, by_rims = Lubrication(system, [0], [solid.mesh], [pivot]), ti.ndarray(ti.f64, (1, 6))
    film.find(still[None])
    film.pressed(system.particles.position, by_rims, found=False)
    return (film.steady + by_rims.to_numpy())[0]


BOX = {"type": "box", "size": [0.24, 0.12, 0.2]}
BOTTOM = 0.24 * 0.2


def even(position: np.ndarray) -> np.ndarray:
    return np.full(len(position), 3000.0)


def at_rest(position: np.ndarray) -> np.ndarray:
    return RHO * G * (0.3 - position[:, 1])


def falling_away(position: np.ndarray) -> np.ndarray:
    return at_rest(position) + 2000.0 * position[:, 0]


def test_the_whole_bottom_is_under_pressure():
    """p A up, at the depth of the ground."""
    lift = lubrication_wrenches({"shape": BOX, "position": [0, 0.06, 0]}, at_rest)
    assert lift[:3] == pytest.approx([0, RHO * G * 0.3 * BOTTOM, 0], abs=0.03 * RHO * G * 0.3 * BOTTOM)
    assert np.abs(lift[3:]).max() < 0.01 * lift[1] * 0.1


@pytest.mark.parametrize("gap", [0.5, 1.0, 1.5])
def test_what_comes_up_faster_than_particles_follow_is_pressed_on_as_before(gap):
    """Water there has no particles yet, so many spacings high, but is no void."""
    lift = lubrication_wrenches({"shape": BOX, "position": [0, 0.06, 0]}, at_rest, raised=0.02 * gap)
    assert lift[1] == pytest.approx(RHO * G * (0.3 - 0.02 * gap) * BOTTOM, rel=0.03)


def test_pressure_that_falls_along_the_bottom_turns_the_body():
    """p = p0 + s x, which is harmonic: the torque of a rectangle is s L^3 W / 12 about z."""
    level = lubrication_wrenches({"shape": BOX, "position": [0, 0.06, 0]}, falling_away)
    assert level[1] == pytest.approx(RHO * G * 0.3 * BOTTOM, rel=0.03)
    assert level[5] == pytest.approx(2000.0 * 0.24**3 * 0.2 / 12, rel=0.2)


@pytest.mark.parametrize("apart", [0.0, 0.1])
def test_a_film_is_dry_where_no_water_comes(apart):
    """Wet on one of four sides: the mean of the harmonic function that is p there and 0 on the others is
    sum_odd 8 w / (l n^3 pi^3) tanh(n pi l / (2 w)) p, for a length l off that side and a width w."""
    water = {"shape": {"type": "box", "size": [0.16, 0.3, 0.2]}, "position": [-0.2 - apart, 0.15, 0]}
    n = np.arange(1, 99, 2)
    share = (8 * 0.2 / (0.24 * n**3 * np.pi**3) * np.tanh(n * np.pi * 0.24 / (2 * 0.2))).sum()
    lift = lubrication_wrenches({"shape": BOX, "position": [0, 0.06, 0]}, even, water)[1]
    assert lift == pytest.approx(0.0 if apart else share * 3000 * BOTTOM, rel=0.3)


@pytest.mark.parametrize("gap", [0.0, 0.4, 2.0])
def test_a_wall_does_not_hold_what_touches_it(gap):
    """A film between wall and body presses on its side as the fluid does on the other; further off there are
    particles."""
    side = 0.12 * 0.2
    push = lubrication_wrenches({"shape": BOX, "position": [0.18 - gap * 0.02, 0.2, 0]}, even)
    assert push[0] == pytest.approx(-3000.0 * side if gap < 1 else 0.0, rel=0.03, abs=1e-9)


def test_nothing_but_the_film_is_pressed_on():
    """In the open there is none."""
    assert not lubrication_wrenches({"shape": BOX, "position": [0, 0.16, 0]}, even).any()
