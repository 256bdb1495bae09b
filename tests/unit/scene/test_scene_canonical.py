"""Equal scenes have equal canonical strings, and different ones differ: they decide what runs again."""

from __future__ import annotations

import pytest

from scene.load import load
from scene.units import Unit

RADIUS = "particle_radius: 25 mm"


def stages(bench, text: str) -> list[str]:
    scene = load(bench.write(text))
    return [settings.canonical() for settings in (scene.simulation, scene.surface, scene.render, scene.film)]


def test_spelling_does_not_matter(bench, scene):
    expected = stages(bench, scene())
    for new in (
        "particle_radius: 0.025",
        "particle_radius: 2.5e-2",
        "particle_radius: 2.5 cm",
        "'particle_radius': 25mm # comment",
        '"particle_radius": 25.0 mm',
        "particle_radius: 25000 µm",
        f"rest_density: 1 g/cm^3\n  {RADIUS}",
        f"viscosity: 1 mm^2/s\n  {RADIUS}",
        f"{RADIUS}\n  surface_tension: 0",
    ):
        assert stages(bench, scene(RADIUS, new)) == expected, new
    assert stages(bench, scene("fps: 12", "fps: 12.0")) == expected
    assert stages(bench, scene("duration: 0.5\nfps: 12\n", "fps: 12\n\nduration: 500 ms\n")) == expected
    assert stages(bench, scene(more="gravity: [0, -981 cm/s^2, -0]")) == expected


def test_values_do_matter(bench, scene):
    texts = [
        scene(),
        scene(RADIUS, "particle_radius: 0.0250001"),
        scene(more="gravity: [0, -9.8, 0]"),
        scene(more="render: {samples: 5}"),
        scene(more="surface: {cube_size: 1.2}"),
        scene(more="film: {crf: 20}"),
        scene("    ball:", "    bull:"),
    ]
    assert len({tuple(stages(bench, text)) for text in texts}) == len(texts)


def test_a_stage_holds_only_its_own_settings(bench, scene):
    simulation, surface, render, film = stages(bench, scene())
    assert stages(bench, scene(more="render: {samples: 5}"))[::3] == [simulation, film]
    assert stages(bench, scene(more="film: {crf: 20}"))[:3] == [simulation, surface, render]
    assert stages(bench, scene("duration: 0.5", "duration: 1")) == [simulation, surface, render, film]


@pytest.mark.parametrize("unit", ["mm", "cm", "µm"])
def test_a_converted_length_is_the_decimal_that_was_typed(unit):
    scale = {"mm": 1000, "cm": 100, "µm": 1_000_000}[unit]
    assert all(Unit("m").convert(f"{n} {unit}") == n / scale for n in range(1, 2000))
