"""The first standing wave of a basin, for every pressure solver.

omega^2 = g k tanh(k H), k = pi / L, for an amplitude that is small beside the depth (Airy; the correction of the
second order, (k a)^2 times some tenths, is 0.1 % here). Viscosity damps the velocity by exp(-2 nu k^2 t), and the
kinetic energy by its square: what is measured so is the numerical viscosity of the solver.

A pool that has come to rest gets the velocities of the wave's potential cosh(k y) cos(k x), and the motion is read as
the share of this field in the velocities.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import curve_fit

from tests.particles import positions, read_frame, velocities
from tests.solvers import SOLVERS, run_changed

G, LENGTH, HEIGHT, LAYERS, FPS = 9.81, 0.5, 0.2, 6, 50
K = np.pi / LENGTH
OMEGA = np.sqrt(G * K * np.tanh(K * HEIGHT))
PERIOD = 2 * np.pi / OMEGA
AMPLITUDE = 0.015
"""Height of the wave at the walls [m]."""
REST = 1.0
"""Time [s] in which the pool comes to rest."""


def field(points: np.ndarray) -> np.ndarray:
    """Velocities of the wave [m/s] at points [m]; the basin's corner is the origin."""
    x, y = points[:, 0], points[:, 1]
    strength = AMPLITUDE * OMEGA / np.sinh(K * HEIGHT)
    u = strength * np.cosh(K * y) * np.sin(K * x)
    v = -strength * np.sinh(K * y) * np.cos(K * x)
    return np.column_stack([u, v, np.zeros_like(u)])


def swing(out, solver: str, layers: int, periods: float) -> tuple[float, float]:
    """Period [s] and numerical viscosity [m^2/s] with so many layers of particles over the depth."""
    spacing = HEIGHT / layers
    thickness = LAYERS * spacing
    spec = {
        "fps": FPS,
        "gravity": [0, -G, 0],
        "containers": {
            "basin": {"type": "box", "size": [LENGTH, 2 * HEIGHT, thickness], "position": [LENGTH / 2, 0, 0]}
        },
        "fluid": {
            "solver": solver,
            "particle_radius": spacing / 2,
            "bodies": {
                "water": {
                    "shape": {"type": "box", "size": [LENGTH, HEIGHT, thickness]},
                    "position": [LENGTH / 2, HEIGHT / 2, 0],
                }
            },
        },
    }
    after = round(REST * FPS)
    last = after + round(periods * PERIOD * FPS)
    run_changed(spec, out, last, lambda x, v: v + field(x), after)
    shares = []
    for frame in range(after, last + 1):
        points = read_frame(out, frame)
        wave = field(positions(points))
        shares.append((velocities(points) * wave).sum() / (wave**2).sum())
    # The frame that the two runs share was written before the wave was added.
    times, shares = np.arange(1, len(shares)) / FPS, np.array(shares[1:])

    def model(t, scale, phase, omega, decay):
        return scale * np.exp(-decay * t) * np.cos(omega * t + phase)

    (_, _, omega, decay), _ = curve_fit(model, times, shares, p0=(1.0, 0.0, OMEGA, 0.1))
    return 2 * np.pi / np.hypot(omega, decay), decay / (2 * K**2)


def test_the_period_of_the_reference():
    assert pytest.approx(0.868, rel=0.001) == PERIOD


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_period(tmp_path, solver):
    period, viscosity = swing(tmp_path, solver, 10, 2)
    print(f"{solver}: {period / PERIOD - 1:+.2%} of the period, nu {viscosity:.2e} m^2/s")
    assert period == pytest.approx(PERIOD, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_period_on_twice_as_many_layers(tmp_path, solver):
    period, viscosity = swing(tmp_path, solver, 20, 4)
    print(f"{solver}: {period / PERIOD - 1:+.2%} of the period, nu {viscosity:.2e} m^2/s")
    assert period == pytest.approx(PERIOD, rel=0.02)
