"""False colours come from what the surface of the water says of the fluid, if it is asked for that."""

from __future__ import annotations

import pytest

ASKED = "surface: {attributes: [vorticity]}"


def look(**settings: object) -> str:
    inside = ", ".join(f"{name}: {value}" for name, value in {"type": "colormap", "high": 3, **settings}.items())
    return f"{{{inside}}}"


def test_one_that_is_asked_for_is_shown(bench, scene):
    water = look(attribute="vorticity", low="5 Hz", high="30 s^-1", map="inferno")
    bench.accepts(scene(more=f"{ASKED}\nrender: {{water: {water}}}"))


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
    "an attribute that there is not": ("surface: {attributes: [curl]}", "surface.attributes", "vorticity"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_what_colormaps_cannot_show_is_refused(bench, scene, mistake):
    more, *words = MISTAKES[mistake]
    bench.refuses(scene(more=more), *words)
