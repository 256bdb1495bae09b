"""Water at rest, for every pressure solver: its volume, its stillness, and the weight that its floor bears.

The floor's pressure is the mean force on it over its area; what walls push along themselves must not bear any of it.
PCISPH is not asked for columns, which its iterations do not hold up (`docs/fluids.md`).
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.support.fluid.solvers import ITERATIVE, SOLVERS, probe, run, steps
from tests.support.particles import positions, read_frame, velocities

RHO, G, WIDTH, D = 1000.0, 9.81, 0.25, 0.05
SOUND = 10 * (2 * G * 1.0) ** 0.5
"""Speed of sound [m/s] of WCSPH, as `auto` takes it for 1 m: at 20 m/s the column swings for half a minute, and what it
loses of its height is over 1 % more than compression takes."""


def column(solver: str, height: float, **more) -> dict:
    """Water that fills a shaft of WIDTH."""
    settings = {"speed_of_sound": SOUND} if solver == "wcsph" else {}
    return {
        "fps": 1,
        "containers": {"shaft": {"type": "box", "size": [WIDTH, 2 * height, WIDTH]}},
        "fluid": {
            "solver": solver,
            "particle_radius": D / 2,
            "bodies": {
                "water": {"shape": {"type": "box", "size": [WIDTH, height, WIDTH]}, "position": [0, height / 2, 0]}
            },
            solver: settings | more,
        },
    }


def height_over(out, frame: int, height: float) -> float:
    """Twice the mean height of the particles, over that of the water."""
    return 2 * float(positions(read_frame(out, frame))[:, 1].mean()) / height


def squeezed(solver: str, height: float) -> float:
    """What compression takes of the mean height, as a share.

    By rho / rho0 - 1 = g (H - y) / c^2 (Cole, first order) what was at y lies lower by g (H y - y^2 / 2) / c^2.
    """
    return 2 * G * height / (3 * SOUND**2) if solver == "wcsph" else 0.0


def counts(out) -> dict:
    return json.loads((out / "summary.json").read_text())["counts"]


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("solver", ["wcsph", *ITERATIVE])
def test_a_column_stands_still_for_a_minute(tmp_path, solver):
    """1 m high, 20 layers: the volume within 1 %, kinetic energy under 1e-4 of the potential."""
    height = 1.0
    out = run(column(solver, height), tmp_path, 60)
    found = [height_over(out, frame, height) for frame in range(30, 61)]
    table = steps(out)
    late = table["time"] > 30
    moving = table["kinetic_energy"][late].mean() / (RHO * G * WIDTH**2 * height**2 / 2)
    print(f"{solver}: height {found[-1]:.4f}, kinetic over potential energy {moving:.1e}, {len(table)} steps")
    assert found == pytest.approx([1 - squeezed(solver, height)] * len(found), abs=0.01)
    assert moving < 1e-4
    assert counts(out)["steps_capped"] == 0


@pytest.mark.slow
@pytest.mark.parametrize("solver", ITERATIVE)
def test_a_tall_column_keeps_its_height_and_counts_what_it_could_not_do(tmp_path, solver):
    """5 x 5 x 100 particles, 20 times as high as wide, from a start without pressures: they may take 4 times as many
    iterations as 25 layers."""
    height = 5.0
    out = run(column(solver, height, max_iterations=25), tmp_path, 3)
    last, told = steps(out), counts(out)
    print(f"{solver}: height {height_over(out, 3, height):.4f}, {told}")
    assert height_over(out, 3, height) == pytest.approx(1.0, abs=0.01)
    capped = (last["pressure_iterations"] >= 100).sum()
    assert told["steps_capped"] >= capped


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_floor_bears_the_weight(tmp_path, solver):
    """Mean pressure on the floor = rho g H, from the force on a plate under a shaft without bottom."""
    width, height, d = 0.4, 0.4, 0.04
    plate = {
        "shape": {"type": "box", "size": [width + 8 * d, 0.2, width + 8 * d]},
        "position": [0, -0.1, 0],
    }
    shaft = {"type": "box", "size": [width, 2, width], "position": [0, -0.2, 0], "open": ["bottom"]}
    spec = {
        "fps": 10,
        "containers": {"shaft": shaft},
        "fluid": {
            "solver": solver,
            "particle_radius": d / 2,
            "bodies": {
                "water": {"shape": {"type": "box", "size": [width, height, width]}, "position": [0, height / 2, 0]}
            },
        },
        "rigid": {"bodies": {"floor": plate}},
        "probes": {"push": {"type": "force", "body": "floor", "rate": 1e6}},
    }
    out = run(spec, tmp_path, 20)
    dt, time = steps(out)["dt"], steps(out)["time"]
    _, push = probe(out, "push", "force_y")
    late = time > 1
    pressure = -(dt * push[1:])[late].sum() / dt[late].sum() / width**2
    print(f"{solver}: {pressure / (RHO * G * height) - 1:+.2%} of the pressure")
    assert pressure == pytest.approx(RHO * G * height, rel=0.02)


@pytest.mark.slow
def test_water_in_a_shaft_does_not_roll_over(tmp_path):
    """12 x 6 x 40 particles, by DFSPH: averaged over cells of two spacings and two seconds, nothing that is up or down
    by walls or in the middle goes faster than a tenth of sqrt(g d), the speed of what falls by half a spacing."""
    d, size = 0.02, np.array([0.24, 0.8, 0.12])
    spec = {
        "fps": 10,
        "containers": {"shaft": {"type": "box", "size": [size[0], 1.5 * size[1], size[2]]}},
        "fluid": {
            "solver": "dfsph",
            "particle_radius": d / 2,
            "bodies": {"water": {"shape": {"type": "box", "size": size.tolist()}, "position": [0, size[1] / 2, 0]}},
        },
    }
    out = run(spec, tmp_path, 40)
    frames = [read_frame(out, frame) for frame in range(20, 41)]
    x, v = (np.concatenate([of(frame) for frame in frames]) for of in (positions, velocities))
    middle = np.abs(x[:, 1] / size[1] - 0.55) < 0.2
    cell = np.floor((x[middle] / size + [0.5, 0, 0.5]) * size / (2 * d))[:, [0, 2]] @ [100, 1]
    streams = [v[middle][cell == one, 1].mean() for one in np.unique(cell)]
    print(f"{min(streams):+.3f} to {max(streams):+.3f} m/s in {len(streams)} cells")
    assert len(streams) == 18
    assert np.abs(streams).max() < 0.1 * np.sqrt(G * d)
