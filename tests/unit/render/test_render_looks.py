"""What looks do to light, and how large their patterns are, in pictures of blocks of 1 m in white light."""

import itertools

import numpy as np
import pytest

from render.looks import LOOKS
from render.looks.spec import OWN
from tests.support.pictures import extent, passes, rest, white_light

OPAQUE = sorted(set(LOOKS) - {"water", "glass", "colormap", "palette", "imported"})
"""Those that any body can have, and that one cannot look through."""
GRAINED = {look.model_fields["type"].annotation.__args__[0] for look in OWN if "grain" in look.model_fields}
ROUGH = GRAINED | {"tiles"}
"""Those whose surface is not even: boards as wide as the block lie level."""
PIXELS = 16
"""Of a block's width, in a row of them."""


def write_block(write_mesh, path):
    corners = list(itertools.product((-0.5, 0.5), repeat=3))
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    write_mesh(path, "x y z", corners, [triangle for a, b, c, d in sides for triangle in ((a, b, c), (a, c, d))])


def camera(width):
    """Far before the middle of what is so wide [m], and all of it."""
    away = 20 * width
    angle = 2 * np.degrees(np.arctan(width / 2 / away))
    return {"position": [0, 0, away + 0.5], "target": [0, 0, 0], "field_of_view": angle}


@pytest.fixture(scope="module")
def row(tmp_path_factory, write_mesh):
    """One block of each opaque look, side by side: reflected light and normals by look, each [16, 16, 3]."""
    folder = tmp_path_factory.mktemp("row")
    simulation, count = folder / "simulation", len(OPAQUE)
    extent(simulation, (-count / 2, -0.5, -0.5), (count / 2, 0.5, 0.5))
    for kind in OPAQUE:
        write_block(write_mesh, simulation / f"body_{kind}.ply")
    rest(simulation, **{kind: (k + 0.5 - count / 2, 0, 0) for k, kind in enumerate(OPAQUE)})
    settings = {"resolution": (PIXELS * count, PIXELS), "samples": 48, "camera": camera(count), **white_light(folder)}
    grain = {kind: {"grain": 0.5} for kind in GRAINED}
    looks = {kind: {"type": kind, "color": "#ffffff"} | grain.get(kind, {}) for kind in OPAQUE}
    pictures = passes(simulation, folder / "out", materials=looks, **settings)
    return {kind: [picture[:, PIXELS * k : PIXELS * (k + 1)] for picture in pictures] for k, kind in enumerate(OPAQUE)}


@pytest.mark.parametrize("kind", OPAQUE)
def test_no_look_gives_more_light_than_it_gets(row, kind):
    """What sends back light of 1 from everywhere has that reflectance; its mean has an error of 0.3 % at most: 256
    pixels of 48 paths, whose light is 10 at most where one in a hundred is as bright."""
    light, _ = row[kind]
    assert 0.5 < light.mean() < 1.003


@pytest.mark.parametrize("kind", OPAQUE)
def test_what_has_a_grain_can_be_felt(row, kind):
    """Normals, in Blender's axes, towards the camera."""
    _, normals = row[kind]
    inside = normals[1:-1, 1:-1]
    assert inside[..., 1].mean() < -0.7
    assert bool(inside[..., ::2].std(axis=(0, 1)).max() > 1e-3) is (kind in ROUGH)


@pytest.mark.parametrize("width", [0.05, 0.1])
def test_rings_of_wood_have_their_width(tmp_path, write_mesh, width):
    """The pith is 7.3 rings to one side and 12.9 below: on the upright through the middle of the end grain, distances
    from it are (7.3^2 + (12.9 + y / width)^2)^(1/2) rings. They wander by one of them."""
    simulation = tmp_path / "simulation"
    extent(simulation, (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    write_block(write_mesh, simulation / "body_block.ply")
    rest(simulation, block=(0, 0, 0))
    look = {"type": "wood", "along": "z", "grain": width, "roughness": 1}
    settings = {"resolution": (16, 256), "samples": 16, "camera": camera(1), **white_light(tmp_path)}
    light, _ = passes(simulation, tmp_path / "out", materials={"block": look}, **settings)
    upwards = light[::-1, 7:9].mean(axis=(1, 2))
    # a ring ends in dark wood, and the next begins in light
    rise = upwards[3:] - upwards[:-3]
    ends = np.count_nonzero((rise[1:-1] > 0.07) & (rise[1:-1] >= rise[:-2]) & (rise[1:-1] > rise[2:]))
    inner, outer = (np.hypot(7.3, 12.9 + y / width) for y in (-0.5, 0.5))
    assert ends == pytest.approx(outer - inner, abs=2)
