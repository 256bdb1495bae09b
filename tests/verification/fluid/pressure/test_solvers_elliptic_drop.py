"""A drop of water that a velocity field (-A x, A y) draws out into an ellipse, for every pressure solver.

Without gravity and friction the field stays linear, u = -A(t) x, v = A(t) y, and the circle becomes an ellipse with
the half axes a, b: da/dt = -A a, db/dt = A b, dA/dt = A^2 (a^2 - b^2) / (a^2 + b^2) (Monaghan 1994). The drop is a
slab between two planes. The field is turned by TURN against the lattice in which the particles begin: along the
lattice it would draw out rows of particles, whose summed densities are too high, and the drop would swell.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.fluid.solvers import ITERATIVE, SOLVERS, run_changed
from tests.support.particles import positions, read_frame

RATE, RADIUS, LAYERS, FPS = 1.0, 1.0, 6, 4
TURN = 0.4
AXES = {0.5: (0.627, 1.595), 1.0: (0.439, 2.276)}
"""Time A0 t: short and long half axis."""


def exact(until: float, number: int = 4000) -> tuple[float, float]:
    """The half axes at `until` by the midpoint rule."""
    state, dt = np.array([RADIUS, RADIUS, RATE]), until / number

    def rates(now):
        a, b, rate = now
        return np.array([-rate * a, rate * b, rate**2 * (a**2 - b**2) / (a**2 + b**2)])

    for _ in range(number):
        state = state + dt * rates(state + dt / 2 * rates(state))
    return state[0], state[1]


def draw(out, solver: str, across: int) -> dict[float, tuple[float, float]]:
    """Half axes at the times of AXES, `across` particles on the radius: of the ellipse with these second moments."""
    spacing = RADIUS / across
    spec = {
        "fps": FPS,
        "gravity": [0, 0, 0],
        "containers": {
            "slab": {
                "type": "box",
                "size": [6, 6, LAYERS * spacing],
                "position": [0, -3, 0],
                "open": ["left", "right", "bottom", "top"],
            }
        },
        "fluid": {
            "solver": solver,
            "particle_radius": spacing / 2,
            "viscosity": 0,
            "wcsph": {"speed_of_sound": 15 * RATE * RADIUS, "artificial_viscosity": 0.01, "wall_damping": 0},
            "bodies": {
                "drop": {
                    "shape": {"type": "cylinder", "radius": RADIUS, "height": LAYERS * spacing},
                    "rotation": [{"axis": [1, 0, 0], "angle": "90 deg"}],
                }
            },
        },
    }
    c, s = np.cos(2 * TURN), np.sin(2 * TURN)
    gradient = RATE * np.array([[-c, -s, 0], [-s, c, 0], [0, 0, 0]])
    run_changed(spec, out, FPS, lambda x, _: x @ gradient)
    frames = {0.0: 0} | {time: round(time * FPS / RATE) for time in AXES}
    squares = {time: np.cov(positions(read_frame(out, frame))[:, :2].T) for time, frame in frames.items()}
    return {time: tuple(RADIUS * np.sqrt(np.linalg.eigvalsh(squares[time] / squares[0.0][0, 0]))) for time in AXES}


def test_the_closed_form():
    for time, axes in AXES.items():
        assert exact(time / RATE) == pytest.approx(axes, abs=5e-4)


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_drop_becomes_the_ellipse(tmp_path, solver):
    for time, axes in draw(tmp_path, solver, 16).items():
        assert axes == pytest.approx(AXES[time], rel=0.03), f"A0 t = {time}"


UNSTEADY = {
    "iisph": "0.2 % off with 8 on the radius, 1 % with 12",
    "dfsph": "0.67 % off with 8 on the radius, 0.66 % with 12, which roundings may turn round",
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "solver",
    [pytest.param(s, marks=pytest.mark.xfail(strict=s != "dfsph", reason=UNSTEADY[s])) for s in ITERATIVE],
)
def test_the_long_axis_converges(tmp_path, solver):
    """At least of first order in the spacing, from 8 over 12 to 18 particles on the radius; the short axis does not."""
    errors = []
    for across in (8, 12, 18):
        (tmp_path / str(across)).mkdir()
        long = draw(tmp_path / str(across), solver, across)[1.0][1]
        errors.append(abs(long / exact(1.0 / RATE)[1] - 1))
    print(f"{solver}: {errors}")
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < errors[0] * 8 / 18
