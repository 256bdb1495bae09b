"""XSPH against its sum, written out, for particles at random."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.fluid.solvers import SOLVERS, run, steps
from tests.support.fluid.systems import load
from tests.support.particles import positions, read_frame, velocities

SPACING, SHARE = 0.02, 0.3
H = 2 * SPACING


def kernel(r: np.ndarray) -> np.ndarray:
    """The cubic spline [1/m^3]."""
    q = r / H
    rest = np.clip(1 - q, 0, None)
    return 8 / (np.pi * H**3) * np.where(q < 0.5, 1 - 6 * q * q * rest, 2 * rest**3)


def test_velocities_become_what_the_sum_says(taichi):
    """v_i + eps sum_j m 2 / (rho_i + rho_j) (v_j - v_i) W_ij  (Monaghan 1989)."""
    from sim.fluid.boundary.boundary import Boundary
    from sim.fluid.boundary.shapes import Shapes
    from sim.fluid.forces.velocity_smoothing import VelocitySmoothing, smoothing_arrays
    from sim.fluid.spec import Fluid
    from sim.fluid.system import FluidSystem

    rng = np.random.default_rng(4)
    x, v, rho = rng.uniform(0, 5 * SPACING, (200, 3)), rng.normal(size=(200, 3)), rng.uniform(500, 1100, 200)
    spec = Fluid(particle_radius=SPACING / 2, xsph=SHARE)
    boundary = Boundary(Shapes([], np.zeros(3), SPACING, H), SPACING, H, H)
    system = FluidSystem(spec, np.zeros(3), boundary, smoothing_arrays(spec, False))
    load(system, x, v, rho)
    system.find_neighbors()
    VelocitySmoothing(system).smooth(1.0)
    w = kernel(np.linalg.norm(x[:, None] - x[None, :], axis=2))
    share = SHARE * system.mass * 2 / (rho[:, None] + rho[None, :]) * w
    wanted = v + (share[:, :, None] * (v[None, :] - v[:, None])).sum(axis=1)
    found = system.particles.numpy("velocity")[np.argsort(system.particles.numpy("tag")[:, 0]), :3]
    np.testing.assert_allclose(found, wanted, atol=2e-6 * np.abs(share).sum(axis=1).max() * np.abs(v).max() + 1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_it_keeps_momentum_and_takes_up_energy(tmp_path, solver):
    """Of two halves of a cube that slide along each other without gravity."""
    half = {"shape": {"type": "box", "size": [0.2, 0.1, 0.2]}}
    shifted = {"position": [0.05, 0.1, 0.03], "velocity": [-1, 0, 0]}
    bodies = {"low": half | {"velocity": [1, 0, 0]}, "high": half | shifted}
    energy = []
    for share in (0.0, 0.1):
        fluid = {"solver": solver, "particle_radius": 0.01, "bodies": bodies, "xsph": share}
        out = run({"fps": 50, "gravity": [0, 0, 0], "fluid": fluid}, tmp_path / f"{share}", 1)
        v = velocities(read_frame(out, 1))
        assert np.linalg.norm(v.sum(axis=0)) < 1e-5 * np.linalg.norm(v, axis=1).sum()
        assert np.isfinite(positions(read_frame(out, 1))).all()
        energy.append(steps(out)["kinetic_energy"][-1])
    assert energy[1] < 0.98 * energy[0]
