"""What differs between versions of Blender is there in this one, and in those that are not here as far as is known."""

from types import SimpleNamespace

import bpy
import pytest

from render.blender import versions
from render.content import nodes
from render.content.materials import default_body_look, make_materials
from render.content.scene import plain
from render.looks import LOOKS
from render.looks.spec import OWN, PRINCIPLED_COLORS, PRINCIPLED_NUMBERS
from render.texturing.spec import ImportedMaterial
from tests.support import textured


@pytest.fixture
def shader():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return versions.empty_nodes(bpy.data.materials.new("any")).nodes.new("ShaderNodeBsdfPrincipled")


@pytest.mark.parametrize("name", PRINCIPLED_COLORS + PRINCIPLED_NUMBERS)
def test_every_input_that_a_scene_may_set_is_there(shader, name):
    assert versions.input_named(shader, name).name == name


@pytest.mark.parametrize("kind", LOOKS)
def test_every_input_that_a_look_sets_is_there(monkeypatch, tmp_path, kind):
    """The graph leaves out what Blender does not know: a renamed input would go unnoticed."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    monkeypatch.chdir(tmp_path)
    textured.write(tmp_path)
    asked = []

    def found(node, name):
        asked.append((node.bl_idname, name, versions_input_named(node, name) is not None))
        return versions_input_named(node, name)

    versions_input_named = versions.input_named
    monkeypatch.setattr(nodes.versions, "input_named", found)
    settings = next(look for look in OWN if look.model_fields["type"].annotation.__args__ == (kind,))
    images = {setting: {"file": "quarters.png"} for setting in ImportedMaterial.MAPS}
    needed = {
        "imported": {"materials": [images]},
        "colormap": {"high": 1.0},
        "palette": {"colors": {"tap": "#ff0000"}},
    }.get(kind, {})
    look = plain(settings.model_validate({"type": kind, **needed}).model_dump(mode="json"))
    make_materials("body", look, 1.0, False, default_body_look(0))
    assert asked and all(there for _, _, there in asked), asked


def test_names_that_were_changed_are_understood_in_both_directions():
    def socket(name, identifier=None):
        return SimpleNamespace(name=name, identifier=identifier or name)

    class Inputs(list):
        def get(self, name):
            return next((socket for socket in self if socket.name == name), None)

    old = SimpleNamespace(inputs=Inputs([socket("Fac"), socket("Clearcoat")]))
    new = SimpleNamespace(inputs=Inputs([socket("Factor", "Fac"), socket("Coat Weight")]))
    assert [versions.input_named(old, name).name for name in ("Factor", "Fac", "Coat Weight")] == [
        "Fac",
        "Fac",
        "Clearcoat",
    ]
    assert [versions.input_named(new, name).name for name in ("Factor", "Fac", "Coat Weight")] == [
        "Factor",
        "Factor",
        "Coat Weight",
    ]
    assert versions.input_named(new, "Coat") is None


def test_layers_stand_side_by_side_in_a_file_of_one_part():
    settings = bpy.context.scene.render.image_settings
    versions.take_format(settings, "OPEN_EXR_MULTILAYER", "RGB", "32")
    assert (settings.file_format, settings.color_depth) == ("OPEN_EXR_MULTILAYER", "32")
    assert getattr(settings, "use_exr_interleave", True)
    versions.take_format(settings, "PNG", "RGB", "8")
    assert (settings.file_format, settings.color_mode, settings.color_depth) == ("PNG", "RGB", "8")


def test_things_that_move_at_once_have_curves_of_their_own():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    things = [bpy.data.objects.new(name, None) for name in "ab"]
    for place, thing in enumerate(things):
        thing.location = (place, 0, 0)
        thing.keyframe_insert("location", frame=1)
    versions.curves(things[0]).clear()
    assert [len(versions.curves(thing)) for thing in things] == [0, 3]
    things[0].keyframe_insert("location", frame=2)
    assert len(versions.curves(things[0])) == 3
