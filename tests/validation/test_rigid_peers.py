"""Rigid bodies beside MuJoCo: a ball on a slope, a row of dominoes, and heaps of 125 boxes.

Ball and dominoes have closed forms or a theory to judge both engines by. Bounds follow from the steps, 4 ms of ours and
1 ms of the peer's: with them a way under constant acceleration is wrong by dt / t, and the time of a blow by one step.

A heap is chaotic: what a box does at its first blow depends on the last digits, so that engines, and the same engine
with another step, differ box by box. What they have to agree in is the mean over several heaps, within three standard
errors of the difference, and in that heaps come to rest.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.validation.domino_wave import arrivals
from tests.validation.rigid_peers import (
    EDGE,
    PILES,
    ROLLING,
    ROLLS,
    ROW,
    SEEN,
    SLIDING,
    START,
    Found,
    Tidemill,
    apart,
    descend,
    dominoes,
    fall,
    incline,
    mujoco,
    pile,
    settle,
    wave,
    way,
)

pytestmark = pytest.mark.slow

ENGINES = {"Tidemill": Tidemill, "MuJoCo": mujoco}


@pytest.fixture(autouse=True)
def _peer() -> None:
    pytest.importorskip("mujoco")


@cache
def fallen(engine: str) -> Found:
    return fall(ENGINES[engine](dominoes()))


@cache
def settled(engine: str) -> dict[str, np.ndarray]:
    found = [settle(ENGINES[engine](pile(seed))).values for seed in range(PILES)]
    return {name: np.array([one[name] for one in found]) for name in found[0]}


@pytest.mark.parametrize(("slope", "friction"), [ROLLING, SLIDING], ids=["rolls", "slides"])
def test_a_ball_goes_as_far_down_a_slope(slope, friction):
    """As the closed form says and as the peer's, to 1 %."""
    ours, peer = (descend(engine(incline(slope, friction)), slope).values["way"] for engine in ENGINES.values())
    assert [ours, peer] == pytest.approx([way(slope, friction, ROLLS)] * 2, rel=0.01)
    assert ours == pytest.approx(peer, rel=0.01)


@pytest.mark.timeout(1200)
@pytest.mark.parametrize("engine", ENGINES)
def test_dominoes_fall_as_theory_says(engine):
    """Its feet do not slide and its blows are instant; here they are given a step of time and little restitution."""
    theory = arrivals(ROW, START, SEEN)
    assert fallen(engine).curve == pytest.approx(theory, rel=0.01)
    assert fallen(engine).values["speed"] == pytest.approx(wave(theory)["speed"], rel=0.013)


@pytest.mark.timeout(1200)
def test_dominoes_fall_at_the_same_times():
    """To 1 %; the speed of the wave to what one step of 4 ms at both ends of its 0.63 s makes, 1.3 %."""
    ours, peer = (fallen(engine) for engine in ENGINES)
    assert ours.curve == pytest.approx(peer.curve, rel=0.01)
    assert ours.values["speed"] == pytest.approx(peer.values["speed"], rel=0.013)


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("name", ["height", "radius"])
def test_heaps_have_the_same_shape(name):
    difference, bound = apart(settled("Tidemill")[name], settled("MuJoCo")[name])
    assert abs(difference) < bound
    assert bound < 0.2 * settled("MuJoCo")[name].mean()


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("engine", ENGINES)
def test_heaps_come_to_rest(engine):
    """All but one box in fifty of a heap, here and there one rocks on; nothing sinks in or creeps."""
    heaps = settled(engine)
    assert heaps["resting"].mean() > 0.98
    assert np.median(heaps["energy"]) < 1e-6
    assert np.median(heaps["drift"]) < 1e-3 * EDGE
    assert np.median(heaps["overlap"]) < 0.01 * EDGE
