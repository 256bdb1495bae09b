"""Where a body's colour comes from."""

import colorsys
import subprocess
import sys
from types import SimpleNamespace

import pytest

from render.content.materials import PLAIN, default_body_look, make_material
from render.content.nodes import TINT, rgba
from render.looks.spec import Glass

RED = (1.0, 0.0, 0.0)


def base_color(look, tinted):
    material = make_material("body", look, 1.0, tinted=tinted)
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


def hsv(name, variation, color=(0.8, 0.4, 0.2)):
    look = SimpleNamespace(type="plastic", color=color, roughness=0.3, variation=variation)
    material = make_material(name, look, 1.0)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    red, green, blue, _ = shader.inputs["Base Color"].default_value
    srgb = [
        1.055 * channel ** (1 / 2.4) - 0.055 if channel > 0.0031308 else 12.92 * channel
        for channel in (red, green, blue)
    ]
    return colorsys.rgb_to_hsv(*srgb)


def test_bodies_differ_by_as_much_as_their_look_says():
    """Of 200 names, in steps that nobody chose: hues to both sides, and none farther than it may be."""
    hue, saturation, value = hsv("ball", 0.0)
    found = [hsv(f"stone_{k}", 0.2) for k in range(200)]
    turns = [h - hue for h, _, _ in found]
    gains = [v / value - 1 for _, _, v in found]
    assert max(map(abs, turns)) <= 0.2 / 4 + 1e-6
    assert max(map(abs, gains)) <= 0.2 + 1e-6
    for values, most in ((turns, 0.05), (gains, 0.2)):
        assert min(values) < -0.9 * most and max(values) > 0.9 * most
        assert sum(values) / 200 == pytest.approx(0, abs=0.15 * most)
    assert all(s == pytest.approx(saturation, abs=1e-5) for _, s, _ in found)


def test_a_body_has_its_colour_in_every_process():
    """Its own, which no other run or Python may change."""
    command = [sys.executable, "-c", "import zlib; print(zlib.crc32(b'hue of ball') / 2**31 - 1)"]
    turn = float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    assert hsv("ball", 0.2)[0] - hsv("ball", 0.0)[0] == pytest.approx(0.2 * turn / 4, abs=1e-5)


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_without_variation_colours_are_as_given(name):
    assert hsv(name, 0.0) == pytest.approx(colorsys.rgb_to_hsv(0.8, 0.4, 0.2), abs=1e-6)
