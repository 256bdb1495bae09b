"""Scenes drawn from all features, cut at some frame and gone on with, give the bytes of the run in one.

`pytest -m slow tests/stress/run/test_resume_anything.py` draws two hundred of them.
"""

from __future__ import annotations

import pytest

from scene.diagnostics.support import refuse_unsupported
from scene.settings import Refused
from sim.spec import SimulationSpec
from tests.stress.any_scene import FRAMES, Draw
from tests.stress.scenes import contents

FAST = (106, 109)
"""Bodies and cloth by symplectic Euler; water and bodies; water that comes, a body and cloth."""
SEEDS = [seed if seed in FAST else pytest.param(seed, marks=pytest.mark.slow) for seed in range(100, 300)]


@pytest.mark.parametrize("seed", SEEDS)
def test_any_scene_goes_on_to_the_same_bytes(simulate, seed):
    scene, cut = Draw(seed).scene(), 1 + seed % (FRAMES - 1)
    refuse_unsupported(SimulationSpec.model_validate(scene))
    try:
        whole = simulate(scene, FRAMES, "whole")
    except Refused as refused:
        pytest.skip(f"refused: {refused.args[0]}")
    first = simulate(scene, cut, "first")
    second = simulate(scene, FRAMES, "second", first=cut + 1, state=first / f"state_{cut:05d}.npz")
    assert contents(first, "*.ply") | contents(second, "*.ply") == contents(whole, "*.ply")
    assert contents(second, f"state_{FRAMES:05d}.npz") == contents(whole, f"state_{FRAMES:05d}.npz")
    assert rows(first / "bodies.csv") + rows(second / "bodies.csv") == rows(whole / "bodies.csv")
    assert rows(first / "probes.csv") + rows(second / "probes.csv") == rows(whole / "probes.csv")


def rows(path) -> list[str]:
    """Of a table that a run may have written, without its head."""
    return path.read_text().splitlines()[1:] if path.exists() else []


@pytest.mark.parametrize("seed", [106, pytest.param(104, marks=pytest.mark.slow)])
@pytest.mark.parametrize("length", [1, 4])
def test_segments_of_any_length_are_the_whole(simulate, seed, length):
    """Where Snakemake cuts a film does not show in it."""
    scene = Draw(seed).scene()
    whole = contents(simulate(scene, FRAMES, "whole"), "*.ply")
    parts, state, first = {}, None, 0
    while first <= FRAMES:
        last = min(first + length - (first > 0), FRAMES)
        part = simulate(scene, last, f"from {first}", first=first, state=state)
        parts |= contents(part, "*.ply")
        state, first = part / f"state_{last:05d}.npz", last + 1
    assert parts == whole
