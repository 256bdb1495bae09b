"""Bodies without torque: momentum is kept exactly, energy nearly, and a tossed book flips when it should."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipk

from tests.support.bodies import box, part, step

SIZE = (0.3, 0.1, 0.6)
MASS = 1000.0 * np.prod(SIZE)
I1, I2, I3 = sorted(MASS / 12 * (a**2 + b**2) for a, b in [(SIZE[1], SIZE[2]), (SIZE[0], SIZE[2]), (SIZE[0], SIZE[1])])
"""Principal moments of inertia [kg m^2]: about z, x and y."""
SPIN = 5.0


def tumbling(rigid: dict | None = None):
    """Spinning about the axis of the middle moment, x, and a little about that of the least, z."""
    return part({"book": box(SIZE, angular_velocity=(SPIN, 0, 0.05))}, gravity=(0, 0, 0), **(rigid or {}))


def period() -> float:
    """4 K(m) sqrt(I1 I2 I3 / ((I3 - I2)(M^2 - 2 E I1))), with 1 and 3 swapped if M^2 < 2 E I2 [s]."""
    first, third = I1, I3
    twice_energy, squared = I2 * SPIN**2 + I1 * 0.05**2, (I2 * SPIN) ** 2 + (I1 * 0.05) ** 2
    if squared < twice_energy * I2:
        first, third = third, first
    m = (I2 - first) * (twice_energy * third - squared) / ((third - I2) * (squared - twice_energy * first))
    return 4 * ellipk(m) * np.sqrt(I1 * I2 * I3 / ((third - I2) * (squared - twice_energy * first)))


def check(seconds: float, **rigid: float) -> tuple[float, float]:
    """Runs, and returns the worst of energy and the mean time between flips over that of theory."""
    bodies = tumbling(rigid)
    momentum, energy = bodies.momentum.copy(), bodies.measure().kinetic_energy
    energies, times, along = [], [], []

    def look(time: float) -> None:
        energies.append(bodies.measure().kinetic_energy)
        times.append(time)
        along.append(bodies.movement(0).rotation[:, 0] @ momentum[0])

    step(bodies, seconds, look)
    assert np.abs(bodies.momentum - momentum).max() <= 1e-5 * np.linalg.norm(momentum)
    signs = np.sign(along)
    flips = np.array(times)[np.flatnonzero(np.diff(signs))]
    # The axis points the other way after half a period of the motion seen from the body.
    pace = float(np.diff(flips).mean() / (period() / 2)) if len(flips) > 1 else np.nan
    return np.abs(np.array(energies) / energy - 1).max(), pace


def test_a_tossed_book_keeps_energy_and_flips_in_time():
    energy, flips = check(12.0)
    assert energy < 1e-3
    assert flips == pytest.approx(1, abs=0.01)


@pytest.mark.slow
def test_for_100_seconds():
    energy, flips = check(100.0)
    assert energy < 0.01
    assert flips == pytest.approx(1, abs=0.01)


def test_the_error_of_energy_is_of_second_order_in_the_step():
    coarse, _ = check(5.0, max_step=0.01)
    fine, _ = check(5.0, max_step=0.005)
    assert coarse / fine == pytest.approx(4, rel=0.1)


def test_a_spin_of_1000_rad_per_second():
    bodies = part({"book": box(SIZE, angular_velocity=(1000, 10, 10))}, gravity=(0, 0, 0))
    energy = bodies.measure().kinetic_energy
    assert min(bodies.step_limits(bodies.measure()).values()) < 0.2 / 1000
    step(bodies, 0.2)
    assert bodies.measure().kinetic_energy == pytest.approx(energy, rel=0.01)


def test_a_throw_is_a_parabola():
    """x = x0 + v t + g t^2 / 2, whatever the step."""
    bodies = part({"book": box(SIZE, velocity=(1, 3, 0), angular_velocity=(1, 2, 3))})
    step(bodies, 0.73)
    assert bodies.position[0] == pytest.approx([0.73, 3 * 0.73 - 9.81 * 0.73**2 / 2, 0], abs=1e-12)


def test_forces_and_torques():
    """F = m a, and M = I alpha about a principal axis."""
    bodies = part({"book": box(SIZE, force=(MASS, 0, 0), torque=(0, I3, 0))}, gravity=(0, 0, 0))
    step(bodies, 0.5, dt=0.001)
    assert bodies.velocity[0] == pytest.approx([0.5, 0, 0], abs=1e-9)
    assert bodies.spin[0] == pytest.approx([0, 0.5, 0], abs=1e-9)
    assert bodies.position[0, 0] == pytest.approx(0.5 * 0.5**2, rel=1e-9)
