"""Sets: what they give for settings that are left open, and what they build around the action."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from pydantic import ValidationError

from render.content.framing import direction, frame_box
from render.content.lights import DISTANCE, _view_factor, add_lights
from render.content.sets import SETS, add_set
from render.content.sets.pool import SLAB
from render.content.sets.site import Site
from render.content.world import add_world
from render.inputs import Box
from render.sets import DEFAULTS
from render.spec import RenderSpec
from tests.support.textured import picture

MATTE = SimpleNamespace(type="matte", color=(0.8, 0.8, 0.8))


def spec(**section):
    return RenderSpec.model_validate(section)


def test_every_set_of_the_settings_can_be_built():
    assert set(DEFAULTS) == set(SETS)
    assert {"none", *SETS} == set(RenderSpec.model_fields["set"].annotation.__args__)


def test_without_a_set_nothing_is_given():
    assert spec(set="none") == spec()


@pytest.mark.parametrize("name", SETS)
def test_a_set_gives_what_is_left_open(name):
    given, made = DEFAULTS[name], spec(set=name)
    assert made.background.type == given["background"]["type"]
    assert made.ground.material.type == given["ground"]["material"]["type"]
    assert made.lights.sun.strength == given["lights"].get("sun", {}).get("strength", spec().lights.sun.strength)
    assert RenderSpec.model_validate_json(made.canonical()) == made


def refused(**section):
    """Sections that the model refuses a value of."""
    try:
        spec(**section)
    except ValidationError as error:
        return {detail["loc"][0] for detail in error.errors()}
    return set()


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("other", [{}, {"unknown": 1}, [], 1.5, "plain", True])
def test_what_is_of_another_kind_is_left_to_the_check_of_its_field(name, other):
    for group, given in DEFAULTS[name].items():
        assert group in refused(set=name, **{group: other}) or isinstance(other, dict)
        for field in given:
            assert refused(set=name, **{group: {field: other}}) <= {group}


def test_what_is_written_goes_above_the_set():
    own = {
        "lights": {"sun": {"strength": 3}, "environment": {"file": "sky.hdr"}},
        "background": {"type": "plain", "color": "#102030"},
        "ground": {"height": 0.3, "material": {"color": "#ff0000"}},
    }
    made = spec(set="table", **own)
    assert (made.lights.sun.strength, made.lights.sun.angle) == (3, DEFAULTS["table"]["lights"]["sun"]["angle"])
    assert made.lights.environment.file == "sky.hdr" and made.lights.softboxes > 0
    assert made.background == spec(background=own["background"]).background
    assert (made.ground.height, made.ground.material.type, made.ground.material.color) == (0.3, "planks", (1, 0, 0))
    assert spec(set="tiles", ground={"material": {"type": "matte"}}).ground.material.type == "matte"
    assert RenderSpec.model_validate_json(made.canonical()) == made


BOX = Box((-0.4, -0.3, 0.0), (0.4, 0.3, 0.6))
EYES = {
    "ahead": ([0.3, 0.5, 2.5], 40),
    "low, from behind": ([-0.6, 0.02, -2.2], 40),
    "from above": ([0.05, 3.0, 0.1], 40),
    "far off": ([30.0, 3.0, 9.0], 3),
    "near and wide": ([0.75, 0.4, 0.6], 110),
}
"""Where cameras stand [m, y up], and their field of view [deg]."""


def depths(tmp_path, write_mesh, name):
    """Distances of all cameras to what they see of a box that fills the action [m], shape [cameras, 32, 32]."""
    import OpenEXR

    simulation, out = tmp_path / "simulation", tmp_path / name
    if not simulation.exists():
        simulation.mkdir()
        corners = [(x, y, z) for x in (-0.4, 0.4) for y in (0.0, 0.6) for z in (-0.3, 0.3)]
        sides = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6)]
        sides += [(0, 6, 4), (1, 5, 7), (1, 7, 3)]
        write_mesh(simulation / "body_block.ply", "x y z", corners, sides)
        rows = ["frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"]
        rows += [f"{frame},{frame},block,0,0,0,1,0,0,0,0,0,0,0,0,0" for frame in range(len(EYES))]
        (simulation / "bodies.csv").write_text("\n".join(rows) + "\n")
        extent = {"min": [-0.4, 0, -0.3], "max": [0.4, 0.6, 0.3]}
        (simulation / "summary.json").write_text(json.dumps({"extent": extent}))
    keys = [
        {"at": frame, "position": place, "target": [0, 0.3, 0], "field_of_view": angle}
        for frame, (place, angle) in enumerate(EYES.values())
    ]
    settings = {"resolution": [32, 32], "samples": 1, "motion_blur": False, "passes": ["depth"], "denoise": False}
    settings |= {"camera": {"keyframes": keys}}
    settings |= {"ground": {"enabled": False}} if name == "none" else {"set": name}
    command = [sys.executable, "-m", "render", "--spec", json.dumps(settings), "--frames", f"0:{len(EYES) - 1}"]
    command += ["--simulation", str(simulation), "--out", str(out), "--fps", "1", "--threads", "1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    found = []
    for path in sorted(out.glob("*.exr")):
        with OpenEXR.File(str(path), separate_channels=True) as file:
            found.append(next(channel.pixels for name, channel in file.channels().items() if "Depth" in name))
    return np.array(found)


def test_no_set_hides_any_part_of_the_action(tmp_path, write_mesh):
    """Wherever a camera sees the box without a set, it sees it at the same distance with one."""
    bare = depths(tmp_path, write_mesh, "none")
    seen = bare < 1e3
    assert (seen.sum(axis=(1, 2)) > 30).all()
    for name in SETS:
        built = depths(tmp_path, write_mesh, name)
        assert built[seen] == pytest.approx(bare[seen], rel=1e-4), name
        assert (built < 1e3).sum() > 1.5 * seen.sum(), f"{name} is there"


def built(name, scale=1.0, basin=None):
    """The objects of a set around a box, by name with the bounds of their corners [m]."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    box = Box(tuple(scale * a for a in BOX.low), tuple(scale * a for a in BOX.high))
    add_set(name, Site(box, 0.0, 3.0 * box.diagonal, MATTE, basin))
    bpy.context.view_layer.update()
    places = {}
    for thing in bpy.data.objects:
        corners = np.array([thing.matrix_world @ vertex.co for vertex in thing.data.vertices])
        places[thing.name] = np.concatenate([corners.min(axis=0), corners.max(axis=0)])
    return places


@pytest.mark.parametrize("name", SETS)
def test_a_set_is_as_large_as_the_action(name):
    small, large = built(name), built(name, 1000.0)
    assert list(small) == list(large)
    for thing, bounds in small.items():
        assert large[thing] == pytest.approx(1000 * bounds, rel=1e-5, abs=1e-2), thing


def test_the_walls_of_a_pool_are_those_of_a_container_that_is_not_drawn():
    """Up to the overlap, by which no film of air is left."""
    basin = Box((-0.5, -0.4, 0.0), (0.5, 0.4, 0.7))
    walls = [bounds for name, bounds in built("pool", basin=basin).items() if name.startswith("wall")]
    nearest = sorted(min(abs(bounds[axis]), abs(bounds[axis + 3])) for bounds in walls for axis in (0, 1))
    assert nearest[:4] == pytest.approx([0.4, 0.4, 0.5, 0.5], abs=0.003)
    assert all(bounds[5] == pytest.approx(0.7) for bounds in walls)


def test_no_wall_of_a_pool_cuts_through_what_is_beside_its_container():
    basin = Box((-0.3, -0.4, 0.0), (0.5, 0.4, 0.7))
    walls = [bounds for name, bounds in built("pool", basin=basin).items() if name.startswith("wall")]
    nearest = sorted(min(abs(bounds[axis]), abs(bounds[axis + 3])) for bounds in walls for axis in (0, 1))
    assert nearest[0] > 0.5, "as without the container, around all of the action"


@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_the_deck_of_a_pool_is_of_slabs_sized_with_the_action(scale):
    """Without joints it was a void as wide as the picture."""
    built("pool", scale)
    decks = [thing for thing in bpy.data.objects if thing.name.startswith("deck")]
    assert len(decks) == 4
    for deck in decks:
        slabs = next(node for node in deck.active_material.node_tree.nodes if node.type == "TEX_BRICK")
        assert slabs.inputs["Brick Width"].default_value == pytest.approx(SLAB * scale * BOX.diagonal)


@pytest.mark.parametrize("scale", [1.0, 0.01])
def test_the_key_light_has_the_irradiance_that_is_asked_for(scale):
    """Lambert's law, summed over the lamp: M cos^2 / (pi r^2) of each patch."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    box = Box(tuple(scale * a for a in BOX.low), tuple(scale * a for a in BOX.high))
    settings = spec(set="studio", lights={"softboxes": 5}).lights
    add_lights(settings, box, frame_box(box, direction(24, 17), (64, 36), 32.0, 0.1))
    lamp, away = bpy.data.lights["key"], DISTANCE * box.diagonal
    side = (np.arange(400) + 0.5) / 400 * lamp.size - lamp.size / 2
    square = side[:, None] ** 2 + side[None, :] ** 2 + away**2
    factor = (away**2 / square / (math.pi * square)).sum() * (lamp.size / 400) ** 2
    assert _view_factor(lamp.size, away) == pytest.approx(factor, rel=1e-4)
    assert lamp.energy / lamp.size**2 * factor == pytest.approx(5, rel=1e-4)
    place = np.array(bpy.data.objects["key"].location) - box.center
    assert np.linalg.norm(place) == pytest.approx(away, rel=1e-5)


def test_a_blurred_panorama_is_as_bright_as_before():
    def panorama(blur):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        environment = SimpleNamespace(light="interior", file=None, strength=0.4, rotation=0.0)
        add_world(environment, SimpleNamespace(type="environment", blur=blur))
        return [
            (image.size[0], np.array(image.pixels[:]).reshape(-1, 4)[:, :3].mean(axis=0)) for image in bpy.data.images
        ]

    (width, bright), (blurred, after) = sorted(panorama(10.0), key=lambda found: -found[0])
    assert (width, blurred) == (1024, 64)
    assert after == pytest.approx(bright, rel=2e-3)
    assert [found[0] for found in panorama(0.0)] == [1024]


@pytest.mark.parametrize("name", SETS)
def test_an_image_lies_on_all_that_shows_the_ground(name, tmp_path):
    """As wide as it is told, wherever a face has that size."""
    (tmp_path / "picture.png").write_bytes(picture())
    look = SimpleNamespace(**vars(MATTE) | {"texture": str(tmp_path / "picture.png"), "texture_size": 0.5})
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_set(name, Site(BOX, 0.0, 3.0, look))
    shown = [thing for thing in bpy.data.objects if thing.active_material.name.startswith(("ground", "wall"))]
    assert shown
    for thing in shown:
        mesh = thing.data
        for face in mesh.polygons:
            at = np.array([mesh.vertices[mesh.loops[corner].vertex_index].co for corner in face.loop_indices])
            on_image = np.array([mesh.uv_layers.active.uv[corner].vector for corner in face.loop_indices])
            across = np.delete(at, int(np.abs(face.normal).argmax()), axis=1)
            assert np.ptp(on_image, axis=0) * 0.5 == pytest.approx(np.ptp(across, axis=0), rel=1e-3, abs=1e-4), name


@pytest.mark.parametrize("name", DEFAULTS)
def test_floor_and_walls_of_a_set_have_one_colour(name):
    """`variation` would turn it by the names of what has it: blue floors had green walls."""
    assert getattr(spec(set=name).ground.material, "variation", 0.0) == 0.0
