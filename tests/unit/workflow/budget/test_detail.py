"""Scenes between presets."""

from __future__ import annotations

from pathlib import Path

import pytest

from scene.load import load
from scene.presets import QUALITIES
from workflow.budget.calibrate import COARSEST
from workflow.budget.detail import Presets

SCENES = Path(__file__).resolve().parents[4] / "scenes"
NAMES = ("bunny", "dam_break", "drape", "everything", "tiny/splash")


@pytest.mark.parametrize("name", NAMES)
def test_whole_details_are_the_presets(name):
    for detail, quality in enumerate(QUALITIES):
        found, preset = Presets(SCENES / f"{name}.yaml").at(detail), load(SCENES / f"{name}.yaml", quality=quality)
        assert found.simulation.canonical() == preset.simulation.canonical()
        assert (found.surface, found.render) == (preset.surface, preset.render)


def test_between_them_numbers_go_by_powers():
    found = Presets(SCENES / "bunny.yaml").at(0.5)
    assert found.simulation.fluid.particle_radius == pytest.approx((0.035 * 0.022) ** 0.5, rel=1e-5)
    assert found.render.resolution == (554, 312)
    assert found.surface.cube_size == pytest.approx((1.25 * 1.0) ** 0.5, rel=1e-5)


def test_below_draft_they_go_on():
    found = Presets(SCENES / "bunny.yaml").at(-1).simulation.fluid.particle_radius
    assert found == pytest.approx(0.035 * 0.035 / 0.022, rel=1e-5)


def test_below_draft_spacings_grow_that_no_preset_changes(tmp_path):
    (tmp_path / "plain.yaml").write_text(PLAIN)
    presets = Presets(tmp_path / "plain.yaml")
    radii = [presets.at(detail).simulation.fluid.particle_radius for detail in (-2, -1, 0, 1, 2)]
    assert radii == pytest.approx([0.01 * 1.4**2, 0.01 * 1.4, 0.01, 0.01, 0.01])
    sheets = [presets.at(detail).simulation.cloth.sheets["sheet"].spacing for detail in (-1, 0, 1)]
    assert sheets == pytest.approx([0.05 * 1.4, 0.05, 0.05])


def test_below_draft_all_but_spacings_stays():
    """As far below as pilots go, steps and cubes by powers were larger than they may be."""
    found, draft = Presets(SCENES / "everything.yaml").at(COARSEST), load(SCENES / "everything.yaml", quality="draft")
    assert found.simulation.fluid.particle_radius > 2 * draft.simulation.fluid.particle_radius
    assert found.simulation.rigid.max_step == draft.simulation.rigid.max_step
    assert found.simulation.cloth.max_step == draft.simulation.cloth.max_step
    assert (found.surface, found.render) == (draft.surface, draft.render)


PLAIN = """\
duration: 1
fps: 10
fluid:
  particle_radius: 0.01
  bodies: {block: {shape: {type: box, size: [0.2, 0.2, 0.2]}}}
cloth:
  sheets: {sheet: {shape: {type: sheet, size: [1, 1]}, spacing: 0.05, position: [0, 2, 0]}}
"""


@pytest.mark.parametrize("name", NAMES)
def test_more_detail_is_never_coarser(name):
    found = [Presets(SCENES / f"{name}.yaml").at(k / 4) for k in range(9)]
    pixels = [scene.render.resolution[0] * scene.render.resolution[1] for scene in found]
    assert pixels == sorted(pixels)
    assert all(side % 2 == 0 for scene in found for side in scene.render.resolution)
    samples = [scene.render.samples for scene in found]
    assert samples == sorted(samples)
    if found[0].simulation.fluid is not None:
        radii = [scene.simulation.fluid.particle_radius for scene in found]
        assert radii == sorted(radii, reverse=True)
