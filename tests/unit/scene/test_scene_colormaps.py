"""False colours, and those of sources, come from what the surface of the water says of the fluid, if it is asked for
that."""

from __future__ import annotations

import pytest

ASKED = "surface: {attributes: [vorticity]}"


def look(**settings: object) -> str:
    inside = ", ".join(f"{name}: {value}" for name, value in {"type": "colormap", "high": 3, **settings}.items())
    return f"{{{inside}}}"


def test_one_that_is_asked_for_is_shown(bench, scene):
    water = look(attribute="vorticity", low="5 Hz", high="30 s^-1", map="inferno")
    bench.accepts(scene(more=f"{ASKED}\nrender: {{water: {water}}}"))


def test_an_age_is_shown_in_seconds(bench, scene):
    water = look(attribute="age", low="100 ms", high="2 s")
    bench.accepts(scene(more=f"surface: {{attributes: [age]}}\nrender: {{water: {water}}}"))


TAP = "events: [{at: 0.1, add: {emitters: {tap: {shape: {type: disc, radius: 0.1}, position: [0, 0.9, 0], speed: 1}}}}]"


def palette(colors: str, asked: str = "surface: {attributes: [source]}") -> str:
    return f"{asked}\nrender: {{water: {{type: palette, colors: {{{colors}}}}}}}\n{TAP}"


def test_a_palette_has_a_colour_for_each_source(bench, scene):
    bench.accepts(scene(more=palette("drop: '#ff0000', tap: '#0000ff'")))


MISTAKES = {
    "another attribute than asked for": (
        f"{ASKED}\nrender: {{water: {look()}}}",
        "no 'speed'",
        "attributes: [vorticity, speed]",
    ),
    "an attribute that nothing asks for": (
        f"render: {{water: {look()}}}",
        "render.water.attribute",
        "surface: {attributes: [speed]}",
    ),
    "a body in false colours": (
        f"{ASKED}\nrender: {{materials: {{ball: {look()}}}}}",
        "render.materials.ball: only the surface",
        "give it as render.water",
    ),
    "foam in false colours": (f"render: {{foam: {look()}}}", "render.foam: only the surface"),
    "a ground in false colours": (f"render: {{ground: {{material: {look()}}}}}", "render.ground.material: only"),
    "a value of another unit": (f"render: {{water: {look(high='3 kg')}}}", "high: expected a number in m/s"),
    "ends the wrong way round": (f"render: {{water: {look(low=4)}}}", "low = 4 must be less than high = 3"),
    "an attribute that is misspelt": (f"render: {{water: {look(attribute='speeed')}}}", "did you mean 'speed'"),
    "no upper end": ("render: {water: {type: colormap}}", "high: missing"),
    "a source as a number": (f"render: {{water: {look(attribute='source')}}}", "source is no number", "palette"),
    "an age of another unit": (
        f"render: {{water: {look(attribute='age', high='3 m')}}}",
        "high: expected a number in s",
    ),
    "a source without a colour": (palette("drop: '#ff0000'"), "render.water.colors", "'tap' has no colour"),
    "a colour of nothing": (palette("drpo: '#ff0000', tap: '#0000ff'"), "colors.drpo", "did you mean 'drop'"),
    "a palette without sources": (
        palette("drop: '#ff0000', tap: '#0000ff'", "surface: {attributes: [age]}"),
        "no 'source'",
        "attributes: [age, source]",
    ),
    "a body with a palette": (
        f"{ASKED}\nrender: {{materials: {{ball: {{type: palette, colors: {{drop: '#ff0000'}}}}}}}}",
        "render.materials.ball: only the surface",
    ),
    "an attribute that there is not": ("surface: {attributes: [curl]}", "surface.attributes", "vorticity"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_what_colormaps_cannot_show_is_refused(bench, scene, mistake):
    more, *words = MISTAKES[mistake]
    bench.refuses(scene(more=more), *words)


def test_a_scene_without_fluid_has_no_surface_to_ask(bench):
    ball = "rigid: {bodies: {ball: {shape: {type: sphere, radius: 0.1}}}}"
    bench.write(f"duration: 1\n{ball}\nsurface: {{attributes: [age]}}\n")
    status, said = bench.check()
    assert status == 2 and "surface.attributes" in said and "no fluid" in said
