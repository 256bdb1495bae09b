"""Foam, spray and bubbles against closed forms; equations are numbered as in Ihmsen et al. (2012)."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from common.ply import FLUID_POINT
from sim.bodies.wall import Wall
from sim.device import runtime
from sim.foam.spec import FoamJobSpec, FoamSpec, TrappedAir

RADIUS, H = 0.01, 0.04
SPACING = 2 * RADIUS
GRAVITY = np.array([0.0, -9.81, 0.0])
STILL = {"trapped_air": {"rate": 0}, "wave_crest": {"rate": 0}}


@pytest.fixture(autouse=True)
def _taichi():
    runtime.start(arch="cpu", threads=1, serial=True)


def job(**foam) -> FoamJobSpec:
    walls = foam.pop("walls", ())
    return FoamJobSpec(foam=foam, particle_radius=RADIUS, support_radius=H, fps=24, walls=walls)


def lattice(edge: int = 11) -> np.ndarray:
    """Points of a cube around the origin, moved by less than a rounding error off the borders of cells."""
    axis = (np.arange(edge) - edge // 2) * SPACING
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3) + 1e-5


def fluid(position: np.ndarray, velocity: np.ndarray):
    from sim.foam.fluid import Fluid

    return Fluid(position, velocity, H, SPACING)


def middle(found) -> int:
    return int(np.linalg.norm(found.position - 1e-5, axis=1).argmin())


def weighted(length) -> float:
    """The sum of `length` of the ways to the neighbours of a point of the lattice, times 1 - r / h."""
    ways = lattice() - 1e-5
    r = np.linalg.norm(ways, axis=1)
    near = (r > 0) & (r < H)
    return float((length(ways[near]) * (1 - r[near] / H)).sum())


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        (lambda x: -3.0 * x, lambda d: 2 * 3.0 * np.linalg.norm(d, axis=1)),
        (lambda x: 3.0 * x, lambda d: 0.0 * d[:, 0]),
        (lambda x: np.cross([0.0, 0.0, 3.0], x), lambda d: 3.0 * np.hypot(d[:, 0], d[:, 1])),
        (lambda x: np.full_like(x, 3.0), lambda d: 0.0 * d[:, 0]),
    ],
    ids=["towards each other", "apart", "around each other", "together"],
)
def test_air_is_trapped_by_what_approaches(field, expected):
    """Equation 2: |v| (1 - cos) is twice the speed head on, the speed itself across, and nothing apart."""
    points = lattice()
    found = fluid(points, field(points))
    trapped, _ = found.potentials()
    assert trapped[middle(found)] == pytest.approx(weighted(expected), rel=1e-4, abs=1e-4)


def test_normals_point_out_of_the_fluid():
    """At a plane surface the gradient of the colour field is 1.4 / h, within the fluid it is none. The outermost layer
    of a lattice lies half a spacing, h / 4, below the surface, where the integral over the plane has fallen to 0.75."""
    from sim.device.arrays import vec4
    from sim.device.compiler import ti
    from sim.foam.sums import surface_normals
    from sim.neighbors.spatial_hash import NeighborList

    found = fluid(lattice(), np.zeros((11**3, 3)))
    lists = NeighborList(64)
    lists.build(found._position, found.count, found._grid, found._position, same=True)
    normal = ti.ndarray(vec4, found.count)
    surface_normals(found.count, H, SPACING**3, found._position, lists.lists, normal)
    normal = normal.to_numpy()
    top = int(np.linalg.norm(found.position - [0, 5 * SPACING, 0], axis=1).argmin())
    assert normal[top, :3] == pytest.approx([0, 1, 0], abs=1e-3)
    assert normal[top, 3] == pytest.approx(halfspace_area(0.25), rel=0.25)
    assert normal[middle(found), 3] == pytest.approx(0, abs=1e-3)


def halfspace_area(q: float) -> float:
    """The integral of the cubic spline over the plane at distance q h, times h, by adding up rings."""
    rho = (np.arange(20000) + 0.5) / 20000
    r = np.sqrt(q * q + rho * rho)
    rest = np.clip(1 - r, 0, None)
    kernel = 8 / math.pi * np.where(r < 0.5, 1 - 6 * r * r * rest, 2 * rest**3)
    return float((2 * math.pi * rho * kernel).sum() / 20000)


def ball(radius: float) -> np.ndarray:
    """Points on spheres a spacing apart, each with one point on the square of a spacing (Fibonacci's spirals)."""
    spheres = []
    for r in radius - (np.arange(6) + 0.5) * SPACING:
        number = round(4 * math.pi * r * r / SPACING**2)
        height = 1 - 2 * (np.arange(number) + 0.5) / number
        turn = np.arange(number) * math.pi * (3 - math.sqrt(5))
        ring = np.sqrt(1 - height**2)
        spheres.append(r * np.stack((ring * np.cos(turn), height, ring * np.sin(turn)), axis=1))
    return np.concatenate(spheres)


@pytest.mark.parametrize("radius", [0.15, 0.3])
def test_crests_are_curved_and_run_ahead(radius):
    """Equations 4 to 7. The normals of a ball's points a way d apart differ by 1 - cos = d^2 / 2 R^2, which times
    1 - d / h adds up over the ball's outer points, one on the square of a spacing s, to pi h^4 / 20 R^2 s^2."""
    points = ball(radius)
    growing = fluid(points, points)
    outer = np.linalg.norm(growing.position, axis=1) > radius - SPACING
    at = radius - SPACING / 2
    expected = math.pi * H**4 / (20 * at**2 * SPACING**2)
    assert np.median(growing.potentials()[1][outer]) == pytest.approx(expected, rel=0.15)
    assert fluid(points, -points).potentials()[1][outer].max() == 0


def test_planes_that_move_are_no_crests():
    points = lattice()
    flat = fluid(points, np.tile([0.0, 2.0, 0.0], (len(points), 1)))
    top = int(np.linalg.norm(flat.position - [0, 5 * SPACING, 0], axis=1).argmin())
    assert flat.potentials()[1][top] == pytest.approx(0, abs=1e-3)


def test_potentials_are_clamped_between_their_bounds():
    from sim.foam.particles import clamp

    shares = clamp(np.array([-1.0, 2.0, 4.5, 7.0, 12.0, 99.0]), TrappedAir(low=2, high=12))
    assert shares == pytest.approx([0, 0, 0.25, 0.5, 1, 1])


def test_slow_fluid_makes_no_foam_and_fast_fluid_all():
    """Equation 9: in proportion to the kinetic energy, so half way between the squares of the speeds."""
    from sim.foam.particles import rates

    spec = FoamSpec(agitation={"low": 1.0, "high": 3.0}, trapped_air={"rate": 100}, wave_crest={"rate": 40})
    full = np.full(4, 1e3)
    velocity = np.array([[1.0, 0, 0], [0, math.sqrt(5.0), 0], [0, 0, -3.0], [8.0, 0, 0]])
    assert rates(full, full, velocity, spec) == pytest.approx([0, 70, 140, 140])


def test_as_many_are_born_as_the_rate_says_where_the_fluid_passes():
    """Equation 10: in cylinders of the particles' radius along their way, evenly over cross-section and length."""
    from sim.foam.particles import born

    rng = np.random.default_rng(1)
    points = lattice()
    velocity = np.tile([0.0, 0.0, 5.0], (len(points), 1)) + rng.choice([-9.0, 9.0], (len(points), 1)) * [1.0, 0, 0]
    step, rate = 0.01, 250.0
    found = fluid(points, velocity)
    spec = job(trapped_air={"rate": rate, "low": 0, "high": 1e-3}, wave_crest={"rate": 0})
    fresh = born(found, spec, step, np.random.default_rng(2))
    expected = rate * step * len(points)
    assert len(fresh) == pytest.approx(expected, abs=5 * math.sqrt(expected))
    away = np.stack([fresh[axis] for axis in "xyz"], axis=1)
    way = np.stack([fresh[axis] for axis in ("vx", "vy", "vz")], axis=1).astype(float)
    speed = math.hypot(9, 5)
    assert np.linalg.norm(way, axis=1) == pytest.approx(np.full(len(way), speed))
    # Each comes from one of the fluid's particles: the one behind it within the cylinder.
    offset = away[:, None, :] - found.position[None, ::1, :]
    along = (offset * (way / speed)[:, None, :]).sum(axis=2)
    across = np.sqrt(np.maximum((offset**2).sum(axis=2) - along**2, 0))
    same = np.sign(found.velocity[None, :, 0]) == np.sign(way[:, None, 0])
    inside = (across <= RADIUS * 1.001) & (along >= -1e-6) & (along <= speed * step * 1.001) & same
    assert inside.any(axis=1).all()
    alone = born(fluid(points[:1] * 0, velocity[:1]), job(), step, np.random.default_rng(2))
    assert len(alone) == 0
    assert fresh["radius"].mean() == pytest.approx(RADIUS / 6, rel=0.02)


def one(position=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0), life=10.0) -> np.ndarray:
    from sim.foam.particles import FOAM_POINT

    return np.array([(*position, *velocity, 1e-3, life, 0)], FOAM_POINT)


def place(points: np.ndarray) -> np.ndarray:
    return np.array([points[axis][0] for axis in "xyz"], float)


@pytest.mark.parametrize("steps", [1, 7])
def test_spray_flies_as_a_stone(steps):
    from sim.foam.particles import SPRAY, moved

    nothing = fluid(np.empty((0, 3)), np.empty((0, 3)))
    points, time = one(velocity=(1.0, 3.0, -2.0)), 0.4
    for _ in range(steps):
        points = moved(points, nothing, job(), time / steps)
    exact = np.array([1.0, 3.0, -2.0]) * time + 0.5 * GRAVITY * time**2
    assert points["kind"][0] == SPRAY
    assert place(points) == pytest.approx(exact, rel=1e-5)
    assert points["life"][0] == 10.0


@pytest.mark.parametrize("steps", [2, 9])
def test_bubbles_rise_to_the_speed_at_which_drag_balances_buoyancy(steps):
    """v' = -k g + (u - v) / tau from rest: x = u_end (t - tau (1 - exp(-t / tau))), whatever the step."""
    from sim.foam.particles import BUBBLE, moved

    stream = np.array([0.3, 0.0, 0.0])
    around = fluid(lattice(), np.tile(stream, (11**3, 1)))
    points, time, buoyancy, tau = one(), 0.05, 2.0, 0.012
    for _ in range(steps):
        points = moved(points, around, job(buoyancy=buoyancy, relaxation_time=tau, **STILL), time / steps)
    end = stream - buoyancy * tau * GRAVITY
    exact = end * (time - tau * (1 - math.exp(-time / tau)))
    assert points["kind"][0] == BUBBLE
    assert place(points) == pytest.approx(exact, rel=1e-4, abs=1e-7)
    assert points["vy"][0] == pytest.approx(buoyancy * 9.81 * tau * (1 - math.exp(-time / tau)), rel=1e-4)


def test_foam_goes_with_the_fluid_and_dies_in_time():
    """On the surface of a fluid that moves evenly."""
    from sim.foam.particles import FOAM, moved

    surface = lattice()[lattice()[:, 1] < 1e-3]
    stream = np.array([1.0, 0.0, 0.5])
    around = fluid(surface, np.tile(stream, (len(surface), 1)))
    start = np.array([0.0, 0.4 * SPACING, 0.0])
    points = one(position=start, velocity=(0.0, 9.0, 0.0), life=0.0175)
    points = moved(points, around, job(**STILL), 0.01)
    assert points["kind"][0] == FOAM
    assert place(points) == pytest.approx(start + 0.01 * stream, rel=1e-5)
    assert points["life"][0] == pytest.approx(0.0075, rel=1e-4)
    assert len(moved(points, around, job(**STILL), 0.01)) == 0


def test_walls_hold_spray_which_then_ages():
    from sim.foam.particles import moved

    floor = Wall(normal=(0.0, 1.0, 0.0), offset=-0.01)
    nothing = fluid(np.empty((0, 3)), np.empty((0, 3)))
    points = moved(one(velocity=(1.0, -5.0, 0.0)), nothing, job(walls=(floor,)), 0.01)
    assert points["y"][0] == pytest.approx(-0.01)
    assert [points[name][0] for name in ("vx", "vy", "vz")] == [0, 0, 0]
    assert points["life"][0] == pytest.approx(9.99)


def motion(position=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0)):
    """Of a body; `turn` and `spin` along their axes [rad, rad/s]."""
    from sim.foam.bodies import Motion

    return Motion(np.array(position), Rotation.from_rotvec(turn), np.array(velocity), np.array(spin))


def crate():
    from sim.bodies.filmed import Body

    return Body(trimesh.creation.box((0.2, 0.4, 0.6)))


def test_a_body_takes_along_what_gets_into_it():
    """To the nearest side of a turned box, with the velocity v + w x r of that point; what is outside stays."""
    from sim.foam.bodies import Placed

    turn, centre = np.array([0.4, -0.7, 1.1]), np.array([3.0, -1.0, 2.0])
    velocity, spin = np.array([0.5, 0.1, -0.3]), np.array([2.0, -1.0, 4.0])
    rotation = Rotation.from_rotvec(turn)
    local = np.array([[0.07, 0.02, -0.05], [-0.03, 0.19, 0.1], [0.01, -0.1, -0.28], [0.101, 0, 0], [0.0, 0.0, 0.301]])
    sides = local.copy()
    sides[0, 0], sides[1, 1], sides[2, 2] = 0.1, 0.2, -0.3
    placed = Placed(crate(), motion(centre, turn, velocity, spin))
    before = rotation.apply(local) + centre
    position, speed, inside = placed.held(before, np.full((5, 3), 9.0))
    assert inside.tolist() == [True, True, True, False, False]
    assert position == pytest.approx(rotation.apply(sides) + centre, abs=1e-12)
    assert speed[:3] == pytest.approx(velocity + np.cross(spin, rotation.apply(sides[:3])), abs=1e-12)
    assert (speed[3:] == 9.0).all()


def test_a_body_between_frames_falls_and_turns_as_it_should():
    """The parabola of a fall and an even turn are exact."""
    from sim.foam.bodies import Passing

    time, share, spin = 0.05, 0.3, np.array([0.0, 6.0, -8.0])
    v0 = np.array([1.0, 2.0, 0.0])
    start = motion((0, 1, 0), (0, 0, 0), v0, spin)
    end = motion(np.array([0, 1, 0]) + v0 * time + GRAVITY * time**2 / 2, spin * time, v0 + GRAVITY * time, spin)
    found = Passing(crate(), start, end).at(share, time).motion
    passed = share * time
    assert found.position == pytest.approx([0, 1, 0] + v0 * passed + GRAVITY * passed**2 / 2)
    assert found.rotation.as_rotvec() == pytest.approx(spin * passed)
    assert found.velocity == pytest.approx(v0 + GRAVITY * passed)
    assert found.angular_velocity == pytest.approx(spin)


def test_spray_lands_on_a_body_that_carries_it_off_and_ages():
    """A drop that falls on a box which moves aside and down, slower than the drop."""
    from sim.foam.bodies import Placed
    from sim.foam.particles import moved

    nothing = fluid(np.empty((0, 3)), np.empty((0, 3)))
    box = Placed(crate(), motion((0, 0, 0), velocity=(0.4, -0.3, 0)))
    points = moved(one(position=(0.02, 0.21, 0.1), velocity=(0.0, -2.0, 0.0)), nothing, job(), 0.01, [box])
    assert place(points) == pytest.approx([0.02, 0.2, 0.1], abs=1e-6)
    assert [points[name][0] for name in ("vx", "vy", "vz")] == pytest.approx([0.4, -0.3, 0], abs=1e-7)
    assert points["life"][0] == pytest.approx(9.99)


def test_foam_begins_outside_of_bodies_and_walls():
    from sim.foam.bodies import Placed
    from sim.foam.particles import born

    found = fluid(lattice(), np.random.default_rng(4).choice([-5.0, 5.0], (11**3, 3)))
    spec = job(trapped_air={"rate": 300, "low": 0, "high": 1e-3}, walls=(Wall(normal=(0, 1, 0), offset=-0.05),))
    box = Placed(crate(), motion((0.15, 0.15, 0)))
    fresh = born(found, spec, 0.01, np.random.default_rng(2), [box])
    position = np.stack([fresh[axis] for axis in "xyz"], axis=1).astype(float)
    free = born(found, job(trapped_air=spec.foam.trapped_air), 0.01, np.random.default_rng(2))
    assert ((free["x"] > 0.06) & (free["y"] > -0.04)).sum() > 100
    assert len(fresh) == len(free)
    within = (np.abs(position - [0.15, 0.15, 0]) < np.array([0.1, 0.2, 0.3]) - 1e-6).all(axis=1)
    assert not within.any()
    assert (position[:, 1] >= -0.05 - 1e-7).all()


def records(position, velocity, ids) -> np.ndarray:
    points = np.zeros(len(ids), FLUID_POINT)
    for axis, name in enumerate("xyz"):
        points[name], points[f"v{name}"] = position[:, axis], velocity[:, axis]
    points["id"] = ids
    return points


def test_the_fluid_between_frames_falls_as_it_should():
    """A cubic and a straight line are exact for a constant acceleration; what comes or goes in between is left out."""
    from sim.foam.fluid import Passage

    x0, v0, time = np.array([[0.0, 1, 0], [5, 5, 5]]), np.array([[2.0, 1, 0], [0, 0, 0]]), 0.04
    x1, v1 = x0 + v0 * time + GRAVITY * time**2 / 2, v0 + GRAVITY * time
    passage = Passage(records(x0, v0, [7, 3]), records(x1, v1, [7, 9]), time)
    position, velocity = passage.at(0.25)
    assert position == pytest.approx(x0[:1] + v0[:1] * 0.01 + GRAVITY * 0.01**2 / 2, rel=1e-6)
    assert velocity == pytest.approx(v0[:1] + GRAVITY * 0.01, rel=1e-6)
