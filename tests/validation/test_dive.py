"""A ball that is dropped on water, a cube that sinks in it and a block that rises, as they were measured.

Kramer et al. 2021 (Energies 14, 269): a sphere half as dense as water, D = 300 mm, let go 30, 90 or 150 mm above where
it floats; how far it dives below that, and when. Wu et al. 2014: a cube of 20 mm, 2.12 times as dense as water, let go
at the surface; how fast it is in the middle of its way. And a block of 49 x 24 x 48 mm, 0.8 times as dense, let go from
the floor under 52 mm of water; when it is up, how fast it bobs, and where it comes to rest.

By DFSPH with all its defaults. The bound is a spacing over the radius of the ball or over the edge of the cube.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scene.load import load
from tests.support.fluid.solvers import run
from tests.support.particles import read_table

BENCH = Path(__file__).resolve().parents[2] / "scenes" / "bench"
RADIUS, MASS, WATER, AREA, DEPTH = 0.15, 7.056, 998.2, 1.2**2, 0.6
TROUGHS = {0.03: 0.02493, 0.09: 0.07573, 0.15: 0.12862}
"""How far below its rest the ball dives, by how far above it is let go [m]."""
PERIODS = {0.03: 0.7869, 0.09: 0.8093, 0.15: 0.8671}
"""The first, damped [s]."""
FROM, TO = 0.0845, 0.0298
"""Heights of the cube between which its speed is taken [m]: it was there at 0.199 and 0.321 s. When it was let go is
known less well than how fast it then was."""
SPEED = (FROM - TO) / 0.122


def simulated(out: Path, name: str, last: int, *overrides: str) -> np.ndarray:
    """bodies.csv of a scene of the benchmarks."""
    scene = load(BENCH / f"{name}.yaml", overrides=overrides)
    run(scene.simulation.model_dump(mode="json", exclude_none=True), out, last)
    return read_table(out / "bodies.csv")


def rest(drop: float) -> float:
    """Height at which the ball floats [m] that is let go `drop` above that: what it takes of the water at first is not
    there."""
    height = DEPTH
    for _ in range(30):
        under = np.clip(DEPTH - (height + drop - RADIUS), 0, 2 * RADIUS)
        taken = np.pi * under**2 * (3 * RADIUS - under) / 3
        height = DEPTH + (MASS / WATER - taken) / AREA
    return float(height)


@pytest.mark.slow
@pytest.mark.parametrize("drop", TROUGHS)
def test_a_ball_dives_as_deep_as_kramer_measured(tmp_path, drop):
    """On 6.25 spacings to the radius; the trough comes half a period after the start, to a tenth of that.

    Where the ball floats is known to some millimetres, as the level of the water is: it is taken from the swing, which
    loses the same share from the start to the trough and from there to the next crest.
    """
    spacing = 0.024
    start = rest(drop) + drop
    settings = [f"fluid.particle_radius={spacing / 2}", "duration=1", f"rigid.bodies.ball.position=[0, {start}, 0]"]
    table = simulated(tmp_path, "heave", 95, *settings)
    lowest = table["y"][:60].argmin()
    trough, crest, time = table["y"][lowest], table["y"][lowest:].max(), table["time"][lowest]
    level = (start * crest - trough**2) / (start + crest - 2 * trough)
    depth = level - trough
    print(f"drop {drop}: {1000 * depth:.1f} mm at {time:.2f} s, {depth / TROUGHS[drop]:.3f}")
    print(f"it swings about {1000 * (level - start + drop):+.1f} mm")
    assert depth == pytest.approx(TROUGHS[drop], rel=spacing / RADIUS)
    assert time == pytest.approx(PERIODS[drop] / 2, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("across", [4, 5, 6])
def test_a_cube_sinks_as_fast_as_wu_measured(tmp_path, across):
    """So many spacings wide."""
    spacing = 0.02 / across
    table = simulated(tmp_path, "sinking", 36, f"fluid.particle_radius={spacing / 2}")
    since, until = np.interp([-FROM, -TO], -table["y"], table["time"])
    speed = (FROM - TO) / (until - since)
    print(f"{across} spacings: {speed:.3f} of {SPEED:.3f} m/s")
    assert speed == pytest.approx(SPEED, rel=spacing / 0.02)


@pytest.fixture(scope="module")
def block(tmp_path_factory) -> np.ndarray:
    """bodies.csv of the block that rises, on 6 spacings to its height."""
    return simulated(tmp_path_factory.mktemp("block"), "rising", 130)


FLOATS = 0.04425
"""Where the middle of the block comes to rest [m], by Archimedes."""


def crests(table: np.ndarray) -> list[int]:
    """Where the block turns round, above where it comes to rest."""
    y = table["y"]
    return [i for i in range(8, len(y) - 8) if y[i] == y[i - 8 : i + 9].max() and y[i] > FLOATS]


@pytest.mark.slow
def test_a_block_leaves_the_floor_and_bobs_as_wu_measured(block):
    """It is up at once: after 0.06 s as far as at the 0.66 m/s^2 of the first 0.2 s. Then it bobs with the period of
    0.367 s, to 15 %, about where Archimedes has it, to half a spacing."""
    time, height = block["time"], block["y"]
    period = np.diff(time[crests(block)][:3]).mean()
    print(f"{1000 * (height[6] - height[0]):.1f} mm at 0.06 s, {period:.3f} s, {1000 * height[-37:].mean():.1f} mm")
    assert height[6] - height[0] > 0.5 * 0.66 * 0.06**2
    assert period == pytest.approx(0.367, rel=0.15)
    assert height[-37:].mean() == pytest.approx(FLOATS, abs=0.002)


@pytest.mark.slow
def test_a_block_rises_as_fast_as_wu_measured(block):
    """It is half its way up, at 28.1 mm, and at its first crest when it was measured to be, to a tenth of the time of
    the crest."""
    half = np.interp((0.012 + FLOATS) / 2, block["y"][:50], block["time"][:50])
    first = block["time"][crests(block)[0]]
    print(f"half way at {half:.3f} s, first crest at {first:.2f} s")
    assert half == pytest.approx(0.2 + 0.1 * (28.1 - 25.2) / (45.2 - 25.2), abs=0.0376)
    assert first == pytest.approx(0.376, abs=0.0376)
