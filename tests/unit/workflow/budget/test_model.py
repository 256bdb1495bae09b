"""Predictions from pilots whose cost is known in closed form."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workflow.budget.detail import Presets
from workflow.budget.model import Flight, Model, Pictures, Surfaces
from workflow.budget.pilot import Drawn, Simulated
from workflow.budget.spacings import spacing
from workflow.plan.memory import particles

SCENE = Path(__file__).resolve().parents[4] / "scenes" / "dam_break.yaml"
STEP, EACH, ITERATION = 2e-3, 1e-7, 3e-8
"""Seconds of a step, of its particle, and of the particle's iteration."""


def took(scene) -> Simulated:
    """Steps as 1 / d, iterations as 1 / sqrt(d), more of both in the second half."""
    frames = scene.last_frame
    later = 1 + (np.arange(frames) >= frames / 2)
    steps = np.round(1e4 / spacing(scene) * 1e-3 * later)
    iterations = 5 / np.sqrt(spacing(scene)) * later
    count = np.full(frames, float(particles(scene)))
    stepping = seconds(steps, count, iterations)
    return Simulated(steps, count, iterations, stepping, overhead=3.0, output=0.0, size=32.0 * count[0], fixed=5e6)


def seconds(steps, count, iterations):
    return steps * (STEP + count * (EACH + ITERATION * iterations))


def surface(scene, cube: float) -> Drawn:
    """n / cube^2 in time, n^(2/3) / cube^2 in size."""
    count = particles(scene)
    return Drawn(1e-5 * count / cube**2, 1.0, 40 * count ** (2 / 3) / cube**2)


def picture(pixels: int, samples: int) -> float:
    return 0.5 + pixels * (1e-6 + 2e-6 * (samples - 1))


@pytest.fixture
def model():
    coarse, fine = Presets(SCENE).at(-2.0), Presets(SCENE).at(-1.0)
    one = {"overhead": 1.0, "size": 1000.0}
    surfaces = Surfaces((surface(coarse, 1.0),), (surface(fine, 1.0),), (surface(fine, 0.5),), (1.0, 0.5))
    pictures = Pictures(
        tuple(Drawn(picture(10_000, 16) * share, **one) for share in (0.5, 1.0, 1.5)),
        Drawn(picture(10_000, 1), **one),
        Drawn(picture(40_000, 1), **one),
        (10_000, 40_000),
        16,
    )
    return Model(Flight(coarse, took(coarse)), Flight(fine, took(fine)), surfaces, pictures)


@pytest.mark.parametrize("detail", [0.0, 1.0, 2.0])
def test_finer_scenes(model, detail):
    scene = Presets(SCENE).at(detail)
    found = model.predict(scene)
    assert found.simulate.sum() == pytest.approx(took(scene).stepping.sum(), rel=0.02)
    assert found.surface == pytest.approx(surface(scene, scene.surface.cube_size).seconds, rel=0.02)
    width, height = scene.render.resolution
    assert found.picture == pytest.approx(picture(width * height, scene.render.samples), rel=1e-6)
    frames = scene.last_frame + 1
    files = 32 * particles(scene) + surface(scene, scene.surface.cube_size).size + 2 * 0.1 * width * height
    assert found.size == pytest.approx(frames * files + 5 * 5e6, rel=0.02)


def test_more_frames_take_as_long_together(model):
    """Presets may differ in their frames a second."""
    scene = Presets(SCENE).at(1.0)
    often = replace(scene, simulation=scene.simulation.model_copy(update={"fps": 2 * scene.simulation.fps}))
    usual, found = model.simulate(scene), model.simulate(often)
    assert len(found) == 2 * len(usual)
    assert found.reshape(-1, 2).sum(axis=1) == pytest.approx(usual, rel=1e-9)


def test_a_probe_corrects_what_the_pilots_did_not_tell(model):
    """Every step 1.7 times as long, as where particles no longer fit the cache."""
    scene = Presets(SCENE).at(1.0)
    whole = took(scene)
    first = {name: getattr(whole, name)[:1] for name in ("steps", "particles", "iterations")}
    probe = replace(whole, **first, stepping=1.7 * whole.stepping[:1])
    model.correct(scene, [probe, probe])
    assert model.predict(scene).simulate.sum() == pytest.approx(1.7 * whole.stepping.sum(), rel=0.02)
