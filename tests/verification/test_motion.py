"""Motion in closed form: free fall, and what a closed system keeps."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.particles import positions, read_frame, read_table, velocities


def drop(**body):
    return {"shape": {"type": "box", "size": [0.02, 0.02, 0.02]}, **body}


def test_a_single_particle_falls_exactly(simulate):
    """x = x0 + v0 t + g t^2 / 2, v = v0 + g t: velocity Verlet is exact for a constant force."""
    g, x0, v0 = np.array([0.3, -9.81, 0.0]), np.array([1.0, 2.0, 3.0]), np.array([0.5, 2.0, -1.0])
    spec = {
        "fps": 10,
        "gravity": g.tolist(),
        "fluid": {"particle_radius": 0.01, "bodies": {"one": drop(position=x0.tolist(), velocity=v0.tolist())}},
    }
    out = simulate(spec, 10)
    steps = len(read_table(out / "steps.csv"))
    for frame in (0, 3, 10):
        t = frame / 10
        point = read_frame(out, frame)
        assert len(point) == 1
        # Rounding only: half a unit in the last place a step, at random.
        tolerance = 1.2e-7 * 10 * np.sqrt(steps)
        np.testing.assert_allclose(positions(point)[0], x0 + v0 * t + g * t * t / 2, atol=tolerance)
        np.testing.assert_allclose(velocities(point)[0], v0 + g * t, atol=tolerance)


@pytest.mark.parametrize("surface_tension", [0.0, 0.5])
def test_a_closed_system_keeps_its_momentum(simulate, surface_tension):
    """Two drops collide without gravity; pair forces are equal and opposite, so sum m v stays."""
    ball = {"type": "sphere", "radius": 0.09}
    spec = {
        "fps": 20,
        "gravity": [0, 0, 0],
        "fluid": {
            "particle_radius": 0.012,
            "viscosity": 1e-3,
            "surface_tension": surface_tension,
            "bodies": {
                "left": {"shape": ball, "position": [-0.11, 0, 0], "velocity": [1.0, 0.2, 0]},
                "right": {"shape": ball, "position": [0.11, 0.03, 0.02], "velocity": [-0.5, 0, 0.1]},
            },
        },
    }
    out = simulate(spec, 6)
    first, last = velocities(read_frame(out, 0)), velocities(read_frame(out, 6))
    assert np.abs(first - last).max() > 0.5, "the drops did not collide"
    scale = np.linalg.norm(first, axis=1).sum()
    assert np.linalg.norm(last.sum(axis=0) - first.sum(axis=0)) < 1e-5 * scale


def test_angular_momentum_is_kept(simulate):
    """Central pair forces: sum x cross v stays (pressure and artificial viscosity act along the pair)."""
    ball = {"type": "sphere", "radius": 0.08}
    spec = {
        "fps": 20,
        "gravity": [0, 0, 0],
        "fluid": {
            "particle_radius": 0.012,
            "bodies": {
                "left": {"shape": ball, "position": [-0.09, -0.04, 0], "velocity": [0.8, 0, 0]},
                "right": {"shape": ball, "position": [0.09, 0.04, 0], "velocity": [-0.8, 0, 0]},
            },
        },
    }
    out = simulate(spec, 6)

    def momentum(frame):
        points = read_frame(out, frame)
        return np.cross(positions(points), velocities(points)).sum(axis=0)

    assert np.linalg.norm(momentum(6) - momentum(0)) < 1e-4 * np.linalg.norm(momentum(0))
