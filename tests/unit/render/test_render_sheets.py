"""Sheets have a thickness, a hem, two sides, and threads that go with the cloth, not with the room."""

import itertools
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from render.content.changing.sheets import Sheet
from render.content.nodes import REST, RIM
from render.content.ply import read_mesh
from render.errors import Unusable
from tests.support.pictures import extent, passes, white_light

NAMES = "x y z vx vy vz rest_x rest_y rest_z thickness"
CELLS = 4
THICKNESS = 0.02
LOOK = {"type": "cloth", "color": (0.5, 0.5, 0.5), "back": None, "roughness": 0.8, "sheen": 0.0, "translucency": 0.0}
PLAIN = {"type": "cloth", "color": "#808080", "sheen": 0, "translucency": 0, "weave": 0, "hem": 0}


def write_sheet(write_mesh, path, wide=1.0, columns=NAMES):
    """A sheet of 1 m by 1 m that faces +z about the origin; drawn out in x to `wide` [m]."""
    grid = list(itertools.product(np.linspace(-0.5, 0.5, CELLS + 1), repeat=2))
    count = len(columns.split())
    vertices = [(wide * x, y, 0, 0, 3, 0, x, 0, -y, THICKNESS)[:count] for x, y in grid]
    corner = np.arange((CELLS + 1) ** 2).reshape(CELLS + 1, CELLS + 1)
    cells = zip(*(c.ravel() for c in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:])), strict=True)
    faces = [face for a, b, c, d in cells for face in ((a, b, c), (a, c, d))]
    path.parent.mkdir(exist_ok=True)
    return write_mesh(path, columns, vertices, faces)


@pytest.fixture
def seen(tmp_path, write_mesh):
    """A picture of the sheet from in front, or from behind, of 64 by 64 pixels across 2 m."""

    def show(look, wide=1.0, side=1, columns=NAMES, **settings):
        simulation = tmp_path / "simulation"
        extent(simulation, (-1, -1, -0.1), (1, 1, 0.1))
        write_sheet(write_mesh, simulation / "cloth_towel_00000.ply", wide, columns)
        angle = float(2 * np.degrees(np.arctan(1 / 40)))
        camera = {"position": [0, 0, side * 40], "target": [0, 0, 0], "field_of_view": angle}
        settings = {"resolution": (64, 64), "camera": camera, **white_light(tmp_path)} | settings
        return passes(simulation, tmp_path / "out", materials={"towel": look}, **settings)[0]

    return show


@pytest.fixture
def sheet(tmp_path, write_mesh):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    source = read_mesh(write_sheet(write_mesh, tmp_path / "cloth_towel_00000.ply"))

    def build(**look):
        found = Sheet(
            "towel", SimpleNamespace(**LOOK | {"thickness": None, "weave": None, "hem": None} | look), source, 9
        )
        found.show(source)
        return found.thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data

    return build


@pytest.mark.parametrize(("wanted", "found"), [(None, 0.9 * THICKNESS), (0.05, 0.05)])
def test_cloth_is_drawn_nearly_as_thick_as_it_is_or_as_asked_for(sheet, wanted, found):
    places = [vertex.co.y for vertex in sheet(thickness=wanted).vertices]
    assert (min(places), max(places)) == pytest.approx((-found / 2, found / 2))


@pytest.mark.parametrize("look", [{"back": (1, 0, 0)}, {"weave": 0.01}, {"hem": 0.01}], ids=str)
def test_what_old_files_do_not_hold_is_refused(tmp_path, write_mesh, look):
    source = read_mesh(write_sheet(write_mesh, tmp_path / "cloth_towel_00000.ply", columns="x y z vx vy vz"))
    wanted = SimpleNamespace(**LOOK | {"thickness": None, "weave": None, "hem": None} | look)
    with pytest.raises(Unusable, match=r"(?s)'towel' has a .*fix: .*, or simulate its frames again"):
        Sheet("towel", wanted, source, 9)


def test_both_sides_are_blurred_by_the_motion_of_the_sheet(sheet):
    """The file has a velocity of 3 m/s along y, which is up."""
    mesh = sheet()
    velocities = {tuple(point.vector) for point in mesh.attributes["velocity"].data}
    assert len(mesh.attributes["velocity"].data) == len(mesh.vertices) == 2 * (2 * CELLS + 1) ** 2
    assert velocities == {(0.0, 0.0, 3.0)}


@pytest.mark.parametrize(("known", "cells"), [("all", 2 * CELLS), ("transmission", CELLS), ("opacity", CELLS)])
def test_files_for_other_programs_have_the_triangles_of_the_simulation(tmp_path, write_mesh, known, cells):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    source = read_mesh(write_sheet(write_mesh, tmp_path / "cloth_towel_00000.ply"))
    look = SimpleNamespace(**LOOK | {"thickness": None, "weave": None, "hem": None})
    found = Sheet("towel", look, source, 9, known=known)
    found.show(source)
    assert len(found.thing.data.polygons) == 2 * cells**2


def test_each_point_knows_its_place_in_the_cloth_and_its_way_to_the_rim(sheet):
    mesh = sheet()
    rest = np.array([point.vector for point in mesh.attributes[REST].data])
    rim = np.array([point.value for point in mesh.attributes[RIM].data])
    for vertex, (u, v, w), way in zip(mesh.vertices, rest, rim, strict=True):
        assert (u, v, w) == pytest.approx((vertex.co.x, -vertex.co.z, 0), abs=1e-6)
        assert way == pytest.approx(0.5 - max(abs(u), abs(v)), abs=1e-6)


@pytest.mark.parametrize("wide", [1.0, 2.0])
def test_there_are_as_many_threads_however_far_the_cloth_is_drawn_out(seen, wide):
    """Ten threads in a metre of cloth, with a gap beside each."""
    light = seen(PLAIN | {"weave": 0.1}, wide=wide, resolution=(256, 256), samples=16).mean(axis=2)
    inside = light[128 - 13 : 128 + 13, int(128 - 62 * wide) : int(128 + 62 * wide)].mean(axis=0)
    dark = inside < inside.mean()
    assert np.count_nonzero(dark[1:] & ~dark[:-1]) == pytest.approx(10, abs=1)


def test_a_hem_is_as_wide_as_it_should_be(seen):
    """Of 15 cm, with a seam, at both ends of a line across 1 m: what is beyond is as without."""
    plain, hemmed = (
        seen(PLAIN | {"hem": hem}, resolution=(128, 128), samples=16)[64].mean(axis=1) for hem in (0, 0.15)
    )
    changed = np.abs(hemmed / plain - 1) > 0.03
    left = np.flatnonzero(changed[:64])
    assert (left[-1] - 32) / 64 == pytest.approx(0.15, abs=1.5 / 64)
    assert left[0] == pytest.approx(32, abs=1)
    assert changed[64:][::-1].sum() == pytest.approx(len(left), abs=2)


@pytest.mark.parametrize("side", [1, -1])
def test_the_other_side_has_its_own_colour(seen, side):
    light = seen(PLAIN | {"color": "#ff0000", "back": "#0000ff"}, side=side)[24:40, 24:40].mean(axis=(0, 1))
    red, blue = light[0] > 5 * light[2], light[2] > 5 * light[0]
    assert (red, blue) == (side > 0, side < 0)


def test_as_much_light_comes_through_thick_cloth_as_through_thin(seen):
    """Black before white: a cloth of which half is translucent, once as the simulation has it, once without."""
    half = PLAIN | {"color": "#ffffff", "translucency": 0.5}
    lamp = {"position": [0, 0, -3], "target": [0, 0, 0], "size": 0.5, "power": 300}
    lights = {"sun": {"strength": 0}, "environment": {"strength": 0}, "areas": [lamp]}
    thick, thin = (
        seen(half, columns=columns, lights=lights, background={"type": "plain"}, samples=64)[24:40, 24:40].mean()
        for columns in (NAMES, "x y z vx vy vz")
    )
    assert thin > 0.1
    assert thick == pytest.approx(thin, rel=0.05)
