"""Particles of a lattice under pressure swing about their places; steps must be short enough for the fastest wave."""

import math
from itertools import product

import numpy as np

from sim.fluid.kernel import cubic_slope_host, lattice, particle_mass
from sim.fluid.time_step_limits import pressure_limit

SUPPORT = 2.0
"""In spacings, by default."""


def slope(r: np.ndarray) -> np.ndarray:
    """(dW/dr) / r [1/m^5] of neighbours at a distance of r spacings of 1 m."""
    return cubic_slope_host(r, SUPPORT)


def highest_frequency() -> float:
    """Of a lattice with spacing, density and pressure 1 [1/s], among waves that keep the density of each particle.

    A particle that is displaced by u exp(i k x) is driven back by m (2 p / rho^2) sum_j (1 - cos k r_j) (Hess W) u; u
    must be normal to sum_j sin(k r_j) grad W, by which its density changes. Waves go over a grid of all k.
    """
    near = lattice(1.0, SUPPORT)
    r = np.linalg.norm(near, axis=1)
    near, r = near[r > 0], r[r > 0]
    step = 1e-5
    bend = (slope(r + step) - slope(r - step)) / (2 * step) / r
    hessian = slope(r)[:, None, None] * np.eye(3) + bend[:, None, None] * near[:, :, None] * near[:, None, :]
    squared = 0.0
    for wave in product(np.linspace(0, math.pi, 13), repeat=3):
        phase = near @ np.array(wave)
        drive = 2 * particle_mass(1.0, SUPPORT, 1.0) * np.tensordot(1 - np.cos(phase), hessian, 1)
        change = (np.sin(phase) * slope(r)) @ near
        if np.linalg.norm(change) > 1e-9:
            along = change / np.linalg.norm(change)
            kept = np.eye(3) - np.outer(along, along)
            drive = kept @ drive @ kept
        squared = max(squared, np.linalg.eigvalsh(drive)[-1])
    return math.sqrt(squared)


def test_the_step_is_stable_for_the_fastest_wave_of_a_lattice_under_pressure():
    """Symplectic Euler is up to 2 over its frequency; a third is left for lattices that are disordered."""
    spacing, density, pressure = 0.01, 1000.0, 4e3
    frequency = highest_frequency() * math.sqrt(pressure / density) / spacing
    stable = 2 / frequency
    assert 0.6 < pressure_limit(spacing, 1.0, pressure, density) / stable < 0.8
