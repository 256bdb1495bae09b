"""Viscous flow between two walls that it sticks to, against the series of the start-up of Poiseuille and Couette flow.

The particles stay where they are, so that nothing but friction is measured; they lie in disorder, as in a flow, since
sums over a lattice depend on how it lies to the flow. What pressure does in a flow, keep it parallel, is done here by
hand: velocities across it are set to zero after every step. Left to themselves they give way to uneven friction, and
the flow is faster by 4 %.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from tests.support.fluid.systems import load
from tests.support.in_time import in_time

NU, LAYERS, SPACING = 0.02, 10, 0.01
GAP = LAYERS * SPACING
BOX = np.array([4 * GAP, GAP, 2 * GAP])
"""The ends are free; what they change fades as exp(-pi x / L) towards the middle. The sides change nothing."""
H = 2 * SPACING
EXPLICIT_LIMIT = 0.125 * (H / 2) ** 2 / NU
G = 2.0


def disordered(rng: np.random.Generator) -> np.ndarray:
    """Particles between y = 0 and GAP [m], shape [n, 3]: thrown in, and pushed apart until they are even."""
    x = rng.uniform(size=(round(BOX.prod() / SPACING**3), 3)) * BOX
    period = BOX * [1, 1e4, 1]
    for _ in range(40):
        below, above = x * [1, -1, 1], x * [1, -1, 1] + [0, 2 * GAP, 0]
        everything = np.concatenate((x, below[x[:, 1] < H], above[x[:, 1] > GAP - H]))
        everything[:, 1] += H
        pairs = cKDTree(everything % period, boxsize=period).query_pairs(H, output_type="ndarray")
        d = everything[pairs[:, 0]] - everything[pairs[:, 1]]
        d -= np.round(d / period) * period
        r = np.linalg.norm(d, axis=1, keepdims=True)
        push = (1 - r / H) ** 2 * d / r
        for column, sign in ((0, 1), (1, -1)):
            for axis in range(3):
                total = np.bincount(pairs[:, column], push[:, axis], minlength=len(everything))
                x[:, axis] += 0.3 * sign * SPACING * total[: len(x)]
        x[:, 1] = np.clip(x[:, 1], 0.1 * SPACING, GAP - 0.1 * SPACING)
        x %= period
    return x


N = np.arange(1, 60)[:, None]
"""Numbers of the modes sin(n pi y / L), which decay at the rates (n pi / L)^2 nu."""


def left(t: float, dt: float) -> np.ndarray:
    """What is left of the modes after the time t [s]: exp(-rate t), or in steps dt of backward Euler
    (1 + rate dt)^(-t/dt)."""
    rate = (N * np.pi / GAP) ** 2 * NU
    return (1 + rate * dt) ** (-t / dt) if dt else np.exp(-rate * t)


def poiseuille(y: np.ndarray, t: float, dt: float = 0.0) -> np.ndarray:
    """u(y, t) [m/s] from rest: G/(2 nu) y (L - y) - sum over odd n of 4 G L^2/(nu pi^3 n^3) sin(n pi y/L)
    exp(-n^2 pi^2 nu t/L^2)  (Morris, Fox & Zhu 1997, eq. 21)."""
    waves = (N % 2) * np.sin(N * np.pi * y / GAP) * left(t, dt) / N**3
    return G / (2 * NU) * y * (GAP - y) - 4 * G * GAP**2 / (NU * np.pi**3) * waves.sum(axis=0)


def couette(y: np.ndarray, t: float, dt: float = 0.0) -> np.ndarray:
    """u(y, t) over the speed of the upper wall, from rest: y/L + sum of 2/(n pi) (-1)^n sin(n pi y/L)
    exp(-n^2 pi^2 nu t/L^2)  (Morris, Fox & Zhu 1997)."""
    waves = (-1.0) ** N * 2 / (N * np.pi) * np.sin(N * np.pi * y / GAP) * left(t, dt)
    return y / GAP + waves.sum(axis=0)


PEAK = G * GAP**2 / (8 * NU)


@pytest.fixture(scope="module")
def points() -> np.ndarray:
    return disordered(np.random.default_rng(1))


DEEP = 4 * SPACING
"""Half of how deep boxes are in place of walls [m]."""
PLACES = {"none": "", "planes": "pp", "boxes": "bb", "floor": "p", "belt": "pm"}
"""What the lower and the upper wall are: a plane, a box, or a box that moves."""


def channel(points: np.ndarray, walls: str, g: float, **settings):
    """A system of particles at rest at these points, driven along x with g [m/s^2].

    walls: `none`, two `planes`, two `boxes`, only a plane below (`floor`), or also a `belt` above, a box that runs with
    1 m/s.
    """
    from sim.fluid.boundary.boundary import Boundary
    from sim.fluid.boundary.shapes import BoundarySolid, Shapes, half_space
    from sim.fluid.forces.velocity_smoothing import smoothing_arrays
    from sim.fluid.pressure import projection
    from sim.fluid.spec import Fluid
    from sim.fluid.system import FluidSystem
    from sim.geometry.distance.sdf import BOX as CUBOID
    from sim.geometry.primitives import Primitive

    spec = Fluid(particle_radius=SPACING / 2, viscosity=NU, **settings)
    half, solids, motions = np.array([0.5 * BOX[0] + DEEP, DEEP, 0.5 * BOX[2] + DEEP]), [], []
    for kind, sign, place in zip(PLACES[walls], (1.0, -1.0), (0.0, GAP), strict=False):
        if kind == "p":
            solids.append(half_space(np.array([0.0, sign, 0.0]), sign * place))
            continue
        origin = np.array([0.5 * BOX[0], place - sign * DEEP, 0.5 * BOX[2]])
        moves = kind == "m"
        solids.append(BoundarySolid(Primitive(CUBOID, half, origin, np.eye(3), half), pivot=origin if moves else None))
        motions += [[*np.eye(3).ravel(), *origin, 1, 0, 0, 0, 0, 0]] * moves
    boundary = Boundary(Shapes(solids, np.zeros(3), SPACING, H), SPACING, H, H)
    boundary.aim(np.array(motions, dtype=float).reshape(-1, 18))
    boundary.move()
    implicit = spec.viscosity_solver == "implicit"
    arrays = projection.ARRAYS + smoothing_arrays(spec, implicit)
    system = FluidSystem(spec, np.array([g, 0, 0]), boundary, arrays, implicit_viscosity=implicit)
    load(system, points, density=spec.rest_density)
    system.find_neighbors()
    return system


def flow(system, dt: float, times: list[float], *, beside: bool = False):
    """Advance in steps dt [s]; yields the time and what was told of its step at each of the times [s].

    beside: friction between particles is found beside densities, as for `iisph` and `dfsph`.
    """
    from sim.fluid.forces.momentum import Momentum
    from sim.fluid.forces.velocity_smoothing import VelocitySmoothing
    from sim.fluid.pressure.incompressible import kick
    from sim.fluid.pressure.projection import Projection

    momentum, smoothing = Momentum(system, pressure=False, friction_known=beside), VelocitySmoothing(system)
    projection = Projection(system, momentum.viscosity)
    particles, step = system.particles, 0
    for time in times:
        while (step + 0.5) * dt < time:
            if beside:
                projection.prepare()
            momentum.accelerate()
            kick(system.count, dt, particles.velocity, particles.acceleration)
            told = smoothing.smooth(dt)
            velocity = particles.velocity.to_numpy()
            velocity[:, 1:3] = 0
            particles.velocity.from_numpy(velocity)
            step += 1
        yield step * dt, told


def profile(system) -> tuple[np.ndarray, np.ndarray]:
    """Height [m] and mean velocity along x [m/s] of ten layers in the middle of the channel."""
    x, v = system.particles.numpy("position"), system.particles.numpy("velocity")
    middle = np.abs(x[:, [0, 2]] - BOX[[0, 2]] / 2).max(axis=1) < GAP / 2
    layer = np.clip(x[middle, 1] / SPACING, 0, LAYERS - 1).astype(int)
    held = np.bincount(layer)
    return np.bincount(layer, x[middle, 1]) / held, np.bincount(layer, v[middle, 0]) / held


REDUCED = (0.05, 0.1, 0.2, 0.5)
"""Times nu t / L^2."""
WALLS = ("planes", "boxes")


@pytest.mark.parametrize("beside", [False, True], ids=["alone", "beside densities"])
@pytest.mark.parametrize("walls", WALLS)
def test_flow_between_walls_starts_as_poiseuille_says(taichi, points, walls, beside):
    """To 3 % of the peak in every layer."""
    system = channel(points, walls, G, viscosity_solver="explicit")
    middle = {}
    times = [reduced * GAP**2 / NU for reduced in REDUCED]
    for t, _ in flow(system, 0.4 * EXPLICIT_LIMIT, times, beside=beside):
        y, u = profile(system)
        middle[t] = poiseuille(np.array([GAP / 2]), t)[0] / PEAK
        np.testing.assert_allclose(u / PEAK, poiseuille(y, t) / PEAK, atol=0.03)
    assert list(middle.values()) == pytest.approx([0.370, 0.615, 0.857, 0.993], abs=0.005)


@pytest.mark.parametrize("solver", ["explicit", *in_time("implicit")])
def test_flow_under_a_belt_starts_as_couette_says(taichi, points, solver):
    """To 3 % of the belt's speed in every layer."""
    system = channel(points, "belt", 0.0, viscosity_solver=solver)
    middle = {}
    for t, _ in flow(system, 0.4 * EXPLICIT_LIMIT, [reduced * GAP**2 / NU for reduced in REDUCED]):
        y, u = profile(system)
        middle[t] = couette(np.array([GAP / 2]), t)[0]
        np.testing.assert_allclose(u, couette(y, t), atol=0.03)
    assert list(middle.values()) == pytest.approx([0.114, 0.263, 0.412, 0.495], abs=0.005)


@pytest.mark.parametrize("walls", WALLS)
def test_implicit_viscosity_takes_steps_a_hundred_times_as_long(taichi, points, walls):
    """The series with the decay of backward Euler, which is what steps of this length can give; to 5 % of the peak:
    within a step nothing keeps the flow parallel."""
    system = channel(points, walls, G, viscosity_solver="implicit")
    dt = 100 * EXPLICIT_LIMIT
    for t, told in flow(system, dt, [dt, 2 * dt, 4 * dt]):
        y, u = profile(system)
        np.testing.assert_allclose(u / PEAK, poiseuille(y, t, dt) / PEAK, atol=0.05)
        assert not told["capped"]
        assert 0 < told["viscosity_iterations"] < 100


@pytest.mark.slow
def test_implicit_and_explicit_viscosity_agree_at_a_small_step(taichi, points):
    """Both are first order in the step, with errors of opposite sign: apart by less than the slowest rate times dt."""
    dt, t = 0.1 * EXPLICIT_LIMIT, 0.1 * GAP**2 / NU
    speeds = []
    for solver in ("explicit", "implicit"):
        system = channel(points, "planes", G, viscosity_solver=solver)
        list(flow(system, dt, [t]))
        speeds.append(profile(system)[1])
    np.testing.assert_allclose(*speeds, atol=(np.pi / GAP) ** 2 * NU * dt * PEAK)


def test_a_film_flows_down_an_incline_as_a_half_parabola(taichi, points):
    """u = g sin(theta) / nu (H y - y^2 / 2), with no stress on the surface y = H; to 8 % of the greatest speed, since
    the film is five layers thick."""
    depth = GAP / 2
    system = channel(points[points[:, 1] < depth], "floor", G, viscosity_solver="implicit")
    long = 10 * depth**2 / NU
    for _ in flow(system, long / 10, [long]):
        y, u = profile(system)
        np.testing.assert_allclose(u / PEAK, 2 * y / depth - (y / depth) ** 2, atol=0.08)


def test_with_free_slip_the_walls_do_not_hold(taichi, points):
    """u = G t everywhere."""
    for solver in ("explicit", "implicit"):
        system = channel(points, "planes", G, viscosity_solver=solver, wall_slip="free_slip")
        for t, _ in flow(system, EXPLICIT_LIMIT / 2, [20 * EXPLICIT_LIMIT]):
            np.testing.assert_allclose(system.particles.numpy("velocity")[:, 0], G * t, rtol=1e-5)


def test_a_shear_wave_decays_as_backward_euler_says(taichi, points):
    """u = sin(k y) between walls at its nodes: (1 + nu k^2 dt)^-n after n steps, to 3 % of the wave."""
    k = 2 * np.pi / GAP
    system = channel(points, "planes", 0.0, viscosity_solver="implicit")
    velocity = system.particles.velocity.to_numpy()
    velocity[: system.count, 0] = np.sin(k * system.particles.numpy("position")[:, 1])
    system.particles.velocity.from_numpy(velocity)
    dt = 20 * EXPLICIT_LIMIT
    for t, _ in flow(system, dt, [dt, 2 * dt, 4 * dt]):
        y, u = profile(system)
        np.testing.assert_allclose(u, np.sin(k * y) * (1 + NU * k * k * dt) ** -round(t / dt), atol=0.03)


@pytest.mark.parametrize("solver", ["explicit", "implicit"])
def test_viscosity_keeps_momentum_and_angular_momentum(taichi, points, solver):
    """Of a block without walls, from velocities at random; to rounding."""
    rng = np.random.default_rng(3)
    system = channel(points, "none", 0.0, viscosity_solver=solver)
    velocity = system.particles.velocity.to_numpy()
    velocity[: system.count, :3] = rng.normal([1, -2, 0.5], size=(system.count, 3))
    system.particles.velocity.from_numpy(velocity)
    before = totals(system)
    from sim.fluid.forces.momentum import Momentum
    from sim.fluid.forces.velocity_smoothing import VelocitySmoothing

    if solver == "implicit":
        told = VelocitySmoothing(system).smooth(50 * EXPLICIT_LIMIT)
        assert told["viscosity_iterations"] > 0
    else:
        from sim.fluid.pressure.incompressible import kick

        Momentum(system, pressure=False).accelerate()
        kick(system.count, EXPLICIT_LIMIT, system.particles.velocity, system.particles.acceleration)
    for value, start in zip(totals(system), before, strict=True):
        scale = np.abs(velocity[: system.count, :3]).sum() * (1 if start is before[0] else BOX[0])
        assert np.linalg.norm(value - start) < 1e-6 * scale


def totals(system) -> tuple[np.ndarray, np.ndarray]:
    """Sums of v and of x cross v."""
    x, v = (system.particles.numpy(name)[:, :3].astype(float) for name in ("position", "velocity"))
    return v.sum(axis=0), np.cross(x, v).sum(axis=0)


@pytest.mark.parametrize("solver", ["explicit", "implicit"])
def test_a_drop_that_turns_goes_on_turning(taichi, points, solver):
    """Viscosity does nothing to a rotation as of a rigid body."""
    system = channel(points, "none", 0.0, viscosity_solver=solver)
    x = system.particles.numpy("position")[:, :3].astype(float)
    velocity = system.particles.velocity.to_numpy()
    velocity[: system.count, :3] = np.cross([1.0, 2.0, -3.0], x - BOX / 2)
    system.particles.velocity.from_numpy(velocity)
    from sim.fluid.forces.momentum import Momentum
    from sim.fluid.forces.velocity_smoothing import VelocitySmoothing
    from sim.fluid.pressure.incompressible import kick

    for _ in range(5):
        Momentum(system, pressure=False).accelerate()
        kick(system.count, EXPLICIT_LIMIT, system.particles.velocity, system.particles.acceleration)
        VelocitySmoothing(system).smooth(EXPLICIT_LIMIT)
    np.testing.assert_allclose(system.particles.velocity.to_numpy(), velocity, atol=1e-4)
