"""The same scene gives the same bytes, in any process and with any number of threads."""

from __future__ import annotations

import numpy as np
import pytest

from tests.stress.scenes import contents, pool, run_segment

SCENE = pool(
    fps=500, fluid__particle_radius=0.005, fluid__surface_tension=0.07, fluid__bodies__water__velocity=[0.5, -1, 0.2]
)
"""8,000 particles."""


def shuffle(state):
    """Bring the particles into random order, so that all threads sort particles into the same cells."""
    with np.load(state) as stored:
        arrays = dict(stored)
    order = np.random.default_rng(7).permutation(len(arrays["fluid.tag"]))
    for name in arrays:
        if name.startswith("fluid."):
            arrays[name] = arrays[name][order]
    np.savez(state, **arrays)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("same")
    assert run_segment(SCENE, folder / "start", "0:0").returncode == 0
    state = folder / "start" / "state_00000.npz"
    shuffle(state)
    for name, threads in (("first", 2), ("second", 2), ("single", 1)):
        done = run_segment(SCENE, folder / name, "1:3", "--resume", state, "--threads", threads)
        assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.parametrize("other", ["second", "single"])
@pytest.mark.parametrize("files", ["fluid_*.ply", "state_*.npz"])
def test_two_processes_write_the_same(runs, files, other):
    assert contents(runs / "first", files) == contents(runs / other, files)


def test_the_scene_moves(runs):
    frames = contents(runs / "first", "fluid_*.ply")
    assert len(frames) == len(set(frames.values())) == 3
