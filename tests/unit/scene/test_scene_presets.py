"""Which value wins: default of the preset < scene < scene's own preset < --set."""

from __future__ import annotations

import pytest

from render.spec import RenderSpec
from scene.load import load
from scene.presets import PRESETS, QUALITIES
from workflow.stages.surface.spec import SurfaceSpec


def samples(bench, text: str, quality: str, *overrides: str) -> int:
    return load(bench.write(text), quality=quality, overrides=overrides).render.samples


def test_precedence(bench, scene):
    plain = scene()
    assert samples(bench, plain, "draft") == PRESETS["draft"]["render"]["samples"]
    own = scene(more="render: {samples: 7}")
    assert samples(bench, own, "draft") == samples(bench, own, "final") == 7
    preset = own + "presets: {final: {render: {samples: 9}}}\n"
    assert samples(bench, preset, "draft") == 7
    assert samples(bench, preset, "final") == 9
    assert samples(bench, preset, "final", "render.samples=11") == 11


@pytest.mark.parametrize("quality", QUALITIES)
def test_presets_are_valid_and_hold_for_what_a_scene_has(bench, scene, quality):
    found = load(bench.write(scene()), quality=quality)
    assert found.surface == SurfaceSpec.model_validate(PRESETS[quality]["surface"])
    assert found.render == RenderSpec.model_validate(PRESETS[quality]["render"])
    assert found.simulation.rigid.max_step == PRESETS[quality].get("rigid", {}).get("max_step", 0.004)
    assert found.simulation.cloth is None
    paced = load(bench.write(scene(more="step: {fixed: 3 ms}")), quality=quality)
    assert paced.simulation.rigid.max_step == 0.004


@pytest.mark.parametrize("quality", QUALITIES)
def test_light_crosses_a_tank_of_water_at_any_quality(bench, scene, quality):
    """With 8 bounces the walls of `dam_break` were black; from 20 on its brightness is that of 48, to a thousandth."""
    assert load(bench.write(scene()), quality=quality).render.bounces >= 20


def test_the_scene_says_which_preset(bench, scene):
    assert load(bench.write(scene())).quality == "draft"
    assert load(bench.write(scene("quality: draft\n"))).quality == "standard"


def test_a_preset_changes_single_values_of_a_group(bench, scene):
    text = scene(more="presets: {draft: {fluid: {bodies: {drop: {position: [0, 0.7, 0]}}}}}")
    fluid = load(bench.write(text), quality="draft").simulation.fluid
    assert fluid.particle_radius == 0.025
    assert fluid.bodies["drop"].position == (0, 0.7, 0)
    assert fluid.bodies["drop"].shape.type == "box"


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("fluid: {particle_radius: 3 s}", "fluid.particle_radius"),
        ("fluid: {solver: wcsp}", "did you mean 'wcsph'?"),
        ("fluid: 3", "must be a group"),
        ("render: {sampels: 3}", "did you mean 'samples'?"),
        ("duration: 0.51", "0.5833333 s"),
        ("render: {materials: {bal: {type: metal}}}", "did you mean 'ball'?"),
        ("rigid: {bodies: {drop: {shape: {type: sphere, radius: 1}}}}", "already a body named 'drop'"),
    ],
)
def test_an_error_in_a_preset_names_its_line(bench, scene, value, words):
    bench.refuses(scene(more=f"presets:\n  draft:\n    {value}"), words, at=f"    {value}")


def test_an_override_keeps_the_lines_of_its_neighbours(bench, scene):
    text = scene("fps: 12", "fps: -1")
    bench.refuses(text, "fps", at="fps: -1", options=("--set", "duration=1"))
    said = bench.refuses(text, "--set fps=-2: fps: must be greater than 0", options=("--set", "fps=-2"))
    assert "fps: -1" not in said


def test_check_looks_at_all_presets(bench, scene):
    bench.write(scene(more="presets: {final: {fps: -1}}"))
    status, said = bench.check()
    assert status == 2
    assert "(draft)" in said and "(standard)" in said and "fps: must be greater than 0" in said


def test_each_solver_has_its_own_step_unless_the_scene_says_which(bench, scene):
    """By half the support: IISPH breaks in an impact from 0.67 on, others go further (tests/stress/limits.py)."""
    dfsph, iisph = (scene("fluid:", f"fluid:\n  solver: {solver}") for solver in ("dfsph", "iisph"))
    assert load(bench.write(dfsph)).simulation.step.cfl == 0.45
    assert load(bench.write(iisph)).simulation.step.cfl == 0.3
    assert load(bench.write(iisph), overrides=["step.maximum=0.1"]).simulation.step.cfl == 0.3
    assert load(bench.write(iisph), overrides=["step.cfl=0.4"]).simulation.step.cfl == 0.4
