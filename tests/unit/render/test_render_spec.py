"""The `render:` section: what is accepted, what is refused, what it costs to import."""

import subprocess
import sys
from typing import get_args

import pytest
from pydantic import ValidationError

from render.looks.spec import Look
from render.spec import RenderSpec

SCALE = {"projection": "orthographic"}


@pytest.mark.parametrize(
    "section",
    [
        {},
        {"camera": SCALE | {"azimuth": 45, "elevation": 35}},
        {"camera": SCALE | {"position": [0, 9, 0.1], "target": [0, 0, 0], "width": "2 m"}},
        {"camera": {"position": [1, 1, 1], "target": [0, 0, 0], "focal_length": "50 mm"}},
        {"lights": {"environment": {"file": "sky.hdr"}}, "materials": {"bunny": {"type": "stone", "grain": "2 cm"}}},
        {"water": {"type": "plastic", "color": "#fff"}, "lights": {"sun": {"strength": 0}}},
    ],
)
def test_canonical_form_reads_back_as_the_same_settings(section):
    spec = RenderSpec.model_validate(section)
    assert RenderSpec.model_validate_json(spec.canonical()) == spec


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ({"camera": None}, "camera missing"),
        ({"camera": {"position": [0, 0, 1]}}, "position and target belong together"),
        ({"camera": {"position": [0, 0, 1], "target": [0, 0, 0], "azimuth": 3}}, "azimuth"),
        ({"camera": {"position": [0, 0, 1], "target": [0, 0, 1]}}, "must differ"),
        ({"resolution": [8, 360]}, "greater than or equal to 16"),
        ({"samples": 0}, "greater than or equal to 1"),
        ({"water": {"color": "blue"}}, "#3a7bd5"),
        ({"materials": {"bunny": {"type": "marble"}}}, "'stone'"),
        ({"lights": {"sun": {"strength": 0}, "environment": {"strength": 0}}}, "no light is left"),
        ({"lights": {"environment": {"light": "city", "file": "a.hdr"}}}, "exclude each other"),
        ({"brightness": 2}, "not permitted"),
    ],
)
def test_refusals_say_what_would_be_right(section, said):
    with pytest.raises(ValidationError, match=said):
        RenderSpec.model_validate(section)


def test_a_colour_has_one_form():
    assert RenderSpec.model_validate({"water": {"color": "#ff0080"}}).water.color == (1.0, 0.0, 0.501961)
    assert RenderSpec.model_validate({"water": {"color": "#f08"}}).water.color == (1.0, 0.0, 0.533333)


def test_names_what_crosses_stages():
    spec = RenderSpec.model_validate(
        {"materials": {"bunny": {"type": "metal"}}, "lights": {"environment": {"file": "sky.hdr"}}}
    )
    assert spec.named_bodies() == ("bunny",)
    assert spec.assets() == ((("lights", "environment", "file"), "sky.hdr"),)


def test_import_is_cheap():
    code = "import render.spec, sys; print([m for m in ('bpy', 'numpy', 'taichi') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_look_of_the_settings_can_be_built():
    from render.looks import LOOKS

    union = get_args(get_args(Look)[0])
    assert {get_args(look.model_fields["type"].annotation)[0] for look in union} == set(LOOKS)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ({"materials": {"a": {"type": "plastic", "principled": {"Coat Wieght": 1}}}}, "Coat Weight"),
        ({"materials": {"a": {"type": "plastic", "principled": {"Base Color": 1}}}}, "must be a colour"),
        ({"materials": {"a": {"type": "glass", "principled": {"Roughness": 1}}}}, "principled"),
        ({"camera": {"width": 2}}, "width is of an orthographic camera"),
        ({"camera": SCALE | {"width": 2}}, "width and automatic framing exclude each other"),
        ({"camera": SCALE | {"position": [0, 0, 1], "target": [0, 0, 0]}}, "width is missing"),
        ({"camera": SCALE | {"field_of_view": 40}}, "field_of_view and an orthographic camera exclude each other"),
        ({"camera": SCALE | {"focal_length": "50 mm"}}, "focal_length and an orthographic camera exclude"),
        ({"camera": SCALE | {"depth_of_field": {"f_stop": 2}}}, "depth_of_field and an orthographic camera exclude"),
        (
            {
                "camera": SCALE
                | {
                    "width": 2,
                    "keyframes": [
                        {"at": 0, "position": [0, 0, 1], "target": [0, 0, 0]},
                        {"at": 1, "position": [0, 0, 2], "target": [0, 0, 0], "field_of_view": 30},
                    ],
                }
            },
            "field_of_view of a keyframe and an orthographic camera",
        ),
        ({"passes": ["motion"]}, "motion_blur: false"),
        ({"passes": ["dept"]}, "depth"),
        ({"camera": {"keyframes": [{"at": 0, "position": [0, 0, 1], "target": [0, 0, 0]}]}}, "two or more"),
        (
            {"camera": {"keyframes": [{"at": at, "position": [0, 0, 1], "target": [0, 0, 0]} for at in (1, 1)]}},
            "must grow",
        ),
    ],
)
def test_looks_that_can_not_be(data, said):
    with pytest.raises(ValidationError, match=said):
        RenderSpec.model_validate(data)
