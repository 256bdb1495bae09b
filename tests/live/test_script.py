"""Scene files of what was played."""

from __future__ import annotations

import pytest

from live.playing.script import Script
from scene.load import load

SCENE = """\
description: Something
duration: 1
fluid:
  particle_radius: 20 mm
  viscosity: 0.001
  bodies:
    water: {shape: {type: box, size: [0.4, 0.4, 0.4]}, position: [0, 0.2, 0]}
containers:
  tank: {type: box, size: [0.4, 0.8, 0.4]}
wedge:
  fluid.viscosity: [0.1, 0.2]
presets:
  draft:
    duration: 2
    fluid: {particle_radius: 40 mm, viscosity: 0.1}
  final:
    fluid: {particle_radius: 10 mm}
"""


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "scenes" / "played.yaml"
    path.parent.mkdir()
    path.write_text(SCENE)
    scene = load(path, quality="draft", overrides=["fluid.viscosity=0.0123", "gravity=[0, -1, 0]"], root=tmp_path)
    return scene, Script(scene).save(path.with_name("saved.yaml"), (), 12)


def test_what_was_saved_is_what_was_played(saved):
    played, again = saved
    assert again.simulation == played.simulation
    assert (again.surface, again.render) == (played.surface, played.render)
    assert again.quality == "draft" and again.last_frame == 12 and again.wedge == ()


def test_what_was_saved_can_be_made_in_full_quality_with_what_was_overridden(saved):
    played, again = saved
    fine, original = (load(scene.path, quality="final") for scene in (again, played))
    assert fine.simulation.fluid.particle_radius == original.simulation.fluid.particle_radius == 0.01
    assert fine.render == original.render and fine.surface == original.surface
    assert fine.render.resolution == (1920, 1080)
    assert fine.simulation.fluid.viscosity == 0.0123 and fine.simulation.gravity == (0, -1, 0)
    assert fine.last_frame == 12
