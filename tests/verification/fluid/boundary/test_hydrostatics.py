"""A pool at rest: p = rho g (H - z), within what a weakly compressible fluid can do.

WCSPH compresses: its density error at depth d is (1 + 7 g d / c^2)^(1/7) - 1 (from Cole's equation of state).
The pool starts without pressure and so rings like a spring, with the period 4 H / c = 0.04 s; probes are
averaged over many periods.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.particles import positions, read_frame, read_table

G, RHO = 9.81, 1000.0
H, SIDE, RADIUS = 0.2, 0.4, 0.01
SPACING = 2 * RADIUS
DEPTHS = (0.06, 0.10, 0.14, 0.18)


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    from sim.segment import simulate
    from sim.spec import SimulationSpec

    out = tmp_path_factory.mktemp("pool")
    spec = {
        "fps": 10,
        "containers": {"tank": {"type": "box", "size": [SIDE, 1.0, SIDE]}},
        "fluid": {
            "particle_radius": RADIUS,
            "wcsph": {"artificial_viscosity": 0.3},
            "bodies": {"water": {"shape": {"type": "box", "size": [SIDE, H, SIDE]}, "position": [0, H / 2, 0]}},
        },
        "probes": {
            **{f"p{i}": {"type": "pressure", "at": [0, H - d, 0], "rate": 400} for i, d in enumerate(DEPTHS)},
            "height": {"type": "water_height", "x": 0, "rate": 100},
            "volume": {"type": "volume", "rate": 100},
        },
    }
    options = {"arch": "cpu", "threads": 1, "quiet": True}
    assert simulate(SimulationSpec.model_validate(spec), out, out, first=0, last=12, **options) == 0
    return out


def settled(out, probe: str) -> float:
    table = read_table(out / "probes.csv")
    values = table["value"][(table["probe"] == probe) & (table["time"] >= 0.6)]
    return float(np.mean(values))


def test_pressure_grows_with_depth(pool):
    pressures = [settled(pool, f"p{i}") for i in range(len(DEPTHS))]
    slope, _ = np.polyfit(DEPTHS, pressures, 1)
    # The gradient of the lattice sum itself is off by 2 % at this support.
    assert slope == pytest.approx(RHO * G, rel=0.02)
    for depth, pressure in zip(DEPTHS, pressures, strict=True):
        # A quarter of a spacing of water: where the surface is, is not known better.
        bound = RHO * G * (SPACING / 4 + 0.02 * depth)
        assert pressure == pytest.approx(RHO * G * depth, abs=bound)


def test_compression_follows_the_equation_of_state(pool):
    c2 = 100 * 2 * G * H
    densities = []
    for frame in range(6, 13):
        points = read_frame(pool, frame)
        x = positions(points)
        inside = (x[:, 1] > SPACING) & (x[:, 1] < 3 * SPACING) & (np.abs(x[:, [0, 2]]).max(axis=1) < SIDE / 4)
        densities.append(points["density"][inside].mean() / RHO - 1)
    expected = (1 + 7 * G * (H - 2 * SPACING) / c2) ** (1 / 7) - 1
    assert np.mean(densities) == pytest.approx(expected, rel=0.3)


def test_the_pool_keeps_its_volume(pool):
    assert settled(pool, "height") == pytest.approx(H, rel=0.02)
    assert settled(pool, "volume") == pytest.approx(SIDE * SIDE * H, rel=0.02)


def test_the_ringing_dies_away(pool):
    table = read_table(pool / "steps.csv")
    early = table["kinetic_energy"][(table["time"] > 0.1) & (table["time"] < 0.4)].max()
    late = table["kinetic_energy"][table["time"] > 0.9].max()
    assert late < 0.5 * early


def test_nothing_passes_the_walls(pool):
    x = positions(read_frame(pool, 12))
    # A lone particle at the surface feels a wall when it has sunk in by a quarter of a spacing.
    assert x[:, 1].min() > 0
    assert np.abs(x[:, [0, 2]]).max() < SIDE / 2 + SPACING / 4
