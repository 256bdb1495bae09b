"""Where a body's colour comes from."""

from types import SimpleNamespace

import pytest

from render.content.materials import PLAIN, default_body_look, make_material
from render.content.nodes import TINT, rgba
from render.looks.spec import Glass

RED = (1.0, 0.0, 0.0)


def base_color(look, tinted):
    material = make_material("body", look, 1.0, tinted)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    return shader.inputs["Base Color"]


@pytest.mark.parametrize(
    ("color", "tinted", "shown"), [(None, False, PLAIN), (RED, False, RED), (RED, True, RED)], ids=str
)
def test_a_colour_of_the_settings_comes_first(color, tinted, shown):
    socket = base_color(SimpleNamespace(type="plastic", color=color, roughness=0.3), tinted)
    assert tuple(socket.default_value) == pytest.approx(rgba(shown))
    assert not socket.is_linked


@pytest.mark.parametrize(
    "look", [SimpleNamespace(type="plastic", color=None, roughness=0.3), default_body_look(2, tinted=True)]
)
def test_without_one_the_vertices_give_it(look):
    socket = base_color(look, True)
    assert socket.links[0].from_node.attribute_name == TINT


@pytest.mark.parametrize("thin", [False, True])
def test_only_thin_glass_bends_no_light(thin):
    look = Glass(type="glass", thin=thin)
    material = make_material("pane", look, 1.0)
    bending = [node for node in material.node_tree.nodes if node.type in ("BSDF_GLASS", "BSDF_REFRACTION")]
    assert (not bending) is thin
