"""The committed JSON schema and reference are up to date, and say what the loader says."""

from __future__ import annotations

import json

import jsonschema
import pytest

from scene.load import load
from scene.reader import parse, read
from workflow import schema
from workflow.plan.shelf import SCENE_FILES


@pytest.fixture(scope="module")
def validator(project) -> jsonschema.Draft202012Validator:
    committed = json.loads((project / schema.SCHEMA).read_text())
    jsonschema.Draft202012Validator.check_schema(committed)
    return jsonschema.Draft202012Validator(committed)


def test_the_committed_files_are_up_to_date(project):
    assert (project / schema.SCHEMA).read_text() == schema.text(), "run python -m workflow.schema"
    reference = (project / schema.REFERENCE).read_text()
    assert reference == schema.markdown(), "run python -m workflow.schema --markdown"


def test_every_scene_names_the_schema_and_fits_it(project, validator):
    scenes = [project / SCENE_FILES.folder / f"{name}.yaml" for name in SCENE_FILES.names(project)]
    assert scenes
    for path in scenes:
        first = path.read_text().splitlines()[0]
        marker = "# yaml-language-server: $schema="
        assert first.startswith(marker), path
        assert (path.parent / first.removeprefix(marker)).resolve() == project / schema.SCHEMA, path
        validator.validate(read(path).data)


GOOD = [
    "presets: {final: {fluid: {particle_radius: 10 mm}}}",
    "presets: {draft: {rigid: {bodies: {ball: {shape: {radius: 0.1}}}}}}",
    "render: {water: {color: '#abc'}}",
    "gravity: [0, -981 cm/s^2, 0]",
    "events: [{at: 100 ms, set: {gravity: [0, 0, 0]}}]",
]


@pytest.mark.parametrize("more", GOOD)
def test_valid_additions(bench, scene, validator, more):
    text = scene(more=more)
    load(bench.write(text))
    validator.validate(parse(text, source="scene").data)


BAD = {
    "unknown key": ("fps: 12", "fpss: 12"),
    "no duration": ("duration: 0.5\n", ""),
    "negative": ("25 mm", "-1"),
    "no quantity": ("25 mm", "large"),
    "unknown shape": ("type: sphere", "type: spere"),
    "two coordinates": ("[0, 0.2, 0]", "[0, 0.2]"),
    "unknown preset": ("quality: draft", "presets: {best: {}}"),
    "unknown key in a preset": ("quality: draft", "presets: {draft: {fluid: {viscosty: 1}}}"),
    "wrong value in a preset": ("quality: draft", "presets: {draft: {render: {samples: 0}}}"),
    "name with a blank": ("ball:", "my ball:"),
}


@pytest.mark.parametrize("case", BAD)
def test_invalid_documents(bench, scene, validator, case):
    data = parse(scene(*BAD[case]), source="scene").data
    assert not validator.is_valid(data)


def test_settings_have_a_unit_or_say_what_they_are(validator):
    radius = validator.schema["$defs"]["Fluid"]["properties"]["particle_radius"]
    assert radius["unit"] == "m" and "spacing" in radius["description"]
    assert radius["anyOf"][0] == {"type": "number", "minimum": 1e-6, "maximum": 10.0}
