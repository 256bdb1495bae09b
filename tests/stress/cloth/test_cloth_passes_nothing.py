"""Nothing passes through cloth, by a checker of its own (`tests.support.passing`)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from tests.support.bodies import box
from tests.support.cloths import INTEGRATORS, passages, passages_in_a_run, scene, sheet
from tests.support.in_time import in_time

FLOOR = {"floor": {"shape": {"type": "plane"}}}
STILL = {"motion": "static"}
BUNNY = {"type": "mesh", "file": "pymeshfix:examples/StanfordBunny.ply", "up": "z", "size": 0.3, "anchor": "base"}

OF_ALL = pytest.mark.parametrize("integrator", INTEGRATORS)

FINE = [0.1, pytest.param(0.05, marks=pytest.mark.slow)]
"""Spacings [m]."""


@pytest.mark.outcome("A")
@pytest.mark.slow
@OF_ALL
@pytest.mark.parametrize("spacing", [0.1, 0.05])
def test_a_cloth_that_falls_on_a_ball(spacing, integrator):
    world = scene(
        {"cloth": sheet((1.0, 1.0), spacing=spacing, position=[0, 0.75, 0], thickness=0.01)},
        FLOOR | {"ball": {"shape": {"type": "sphere", "radius": 0.25}, "position": [0, 0.45, 0]}},
        cloth={"integrator": integrator},
    )
    assert passages(world, 0.5, 0.005) == 0
    assert 0.004 < world.cloth.vertices("cloth")[0][:, 1].min() < 0.4


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", ["implicit_euler", *in_time("xpbd", "symplectic_euler")])
@pytest.mark.parametrize("spacing", FINE)
def test_a_cloth_that_falls_on_the_edge_of_a_box(spacing, integrator):
    edge = box((0.4, 0.4, 1.4), position=[0, 0.5, 0], rotation=[{"axis": [0, 0, 1], "angle": 45}]) | STILL
    cloth = sheet((1.0, 1.0), spacing=spacing, position=[0, 0.82, 0], thickness=0.01)
    world = scene({"cloth": cloth}, FLOOR | {"box": edge}, cloth={"integrator": integrator})
    assert passages(world, 0.5, 0.005) == 0
    assert np.abs(world.cloth.vertices("cloth")[0][:, 0].mean()) < 0.05


@pytest.mark.outcome("A")
@pytest.mark.slow
@OF_ALL
def test_a_ball_that_is_shot_at_a_cloth(integrator):
    """1 cm across at 50 m/s: further in a step than it is thick."""
    ball = {"shape": {"type": "sphere", "radius": 0.005}, "motion": "prescribed", "position": [0.013, 0.3, 0.017],
            "velocity": [0, -50, 0]}  # fmt: skip
    world = scene(
        {"cloth": sheet((0.3, 0.3), spacing=0.03, thickness=0.004, pins=["corners"], stretch_stiffness=1e4)},
        {"ball": ball},
        cloth={"integrator": integrator},
    )
    assert passages(world, 0.0085, 0.0005) == 0
    assert world.cloth.vertices("cloth")[0][:, 1].min() < -0.1


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", in_time("xpbd", "symplectic_euler", "implicit_euler"))
def test_a_cloth_finer_than_it_is_thick_that_falls_on_end(integrator):
    """Upright, it buckles, and comes to lie in folds on itself."""
    upright = [{"axis": [0, 0, 1], "angle": 88}]
    cloth = sheet((0.24, 0.06), spacing=0.012, thickness=0.02, position=[0, 0.14, 0], rotation=upright)
    world = scene({"cloth": cloth | {"bend_stiffness": 1e-5}}, FLOOR, cloth={"integrator": integrator})
    assert passages(world, 0.6, 0.005) == 0
    height = world.cloth.vertices("cloth")[0][:, 1]
    assert height.min() > 0.009
    assert height.max() < 0.12


@pytest.mark.outcome("A")
@pytest.mark.slow
@OF_ALL
def test_two_cloths_between_closing_plates(integrator):
    plate = {"shape": {"type": "box", "size": [0.8, 0.05, 0.8]}, "motion": "prescribed"}
    closing = {
        "low": plate | {"keyframes": [{"at": 0, "position": [0, -0.08, 0]}, {"at": 0.4, "position": [0, -0.035, 0]}]},
        "high": plate | {"keyframes": [{"at": 0, "position": [0, 0.08, 0]}, {"at": 0.4, "position": [0, 0.035, 0]}]},
    }
    cloth = sheet((0.4, 0.4), spacing=0.04, thickness=0.006)
    turned = [{"axis": [0, 1, 0], "angle": 30}]
    world = scene(
        {"one": cloth | {"position": [0, -0.02, 0]}, "two": cloth | {"position": [0, 0.02, 0], "rotation": turned}},
        closing,
        cloth={"integrator": integrator},
    )
    assert passages(world, 0.5, 0.005) == 0
    heights = [world.cloth.vertices(name)[0][:, 1] for name in ("one", "two")]
    assert heights[0].mean() < heights[1].mean()
    assert max(np.abs(np.concatenate(heights))) < 0.01


@pytest.mark.outcome("C")
@pytest.mark.slow
@pytest.mark.parametrize(("fps", "settings"), [(500, {"max_step": 0.002}), (24, {})], ids=["fine", "default"])
def test_a_ribbon_that_is_twisted_ten_times(fps, settings, tmp_path):
    """In a second. Next to the ends, which pins keep straight, threads are several times as long as at rest after some
    turns, and in the end there is no way out, even with the shortest steps of a run: it stops then, and whatever it has
    written is good. Five turns are possible."""
    pins = ["left", {"at": "right", "angular_velocity": [62.83, 0, 0]}]
    ribbon = sheet((0.6, 0.06), spacing=0.01, thickness=0.003, pins=pins)
    met, last = passages_in_a_run({"fps": fps, "cloth": {"sheets": {"ribbon": ribbon}, **settings}}, tmp_path, fps)
    assert met == 0
    assert last >= 0.5 * fps


@pytest.mark.outcome("A")
@pytest.mark.slow
def test_a_cloth_that_falls_on_the_bunny():
    bunny = {"shape": BUNNY, "position": [0, 0, 0]} | STILL
    cloth = sheet((0.5, 0.5), spacing=0.04, position=[0, 0.36, 0], thickness=0.008)
    world = scene({"cloth": cloth}, FLOOR | {"bunny": bunny})
    assert passages(world, 0.4, 0.005) == 0
    assert 0.003 < world.cloth.vertices("cloth")[0][:, 1].min() < 0.2


CORNERS = np.array([[-0.2, 0, -0.2], [0.2, 0, -0.2], [-0.2, 0, 0.2], [0.2, 0, 0.2]])
"""Of a cloth before it is folded [m]."""


def half_turns(corner, *folds):
    """A pin that leads a corner by half turns around level lines: when each begins and ends [s], which axis crosses the
    line, and where on that axis and how high it is [m]. Lines as high as the middle of a pile turn it over whole."""
    keys, place = [], np.array(corner, float)
    for begun, ended, axis, middle, height in folds:
        lever = place[[axis, 1]] - [middle, height]
        for part in np.linspace(0, 1, 7):
            # Towards the middle, over the top.
            angle = np.sign(lever[0]) * np.pi * part
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            place[[axis, 1]] = [middle, height] + turn @ lever
            keys.append({"at": begun + part * (ended - begun), "offset": (place - corner).tolist()})
    return {"at": [list(corner)], "keyframes": keys}


@pytest.mark.outcome("A")
@pytest.mark.slow
@OF_ALL
def test_a_cloth_that_is_folded_three_times(integrator):
    """By its corners, onto itself: eight layers in the end, four of them held at a corner, 12 mm apart."""
    x, z = 0, 2
    first, second, third = (0.0, 0.6, x, 0.0, 0.006), (0.8, 1.4, z, 0.0, 0.018), (1.6, 2.2, x, -0.1, 0.042)
    ways = [(second, third), (first, second, third), (third,), (first, third)]
    pins = [half_turns(corner, *folds) for corner, folds in zip(CORNERS, ways, strict=True)]
    world = scene(
        {"cloth": sheet((0.4, 0.4), spacing=0.04, thickness=0.006, pins=pins, damping=0.2, bend_stiffness=1e-6)},
        {"floor": {"shape": {"type": "plane"}, "position": [0, -0.01, 0]}},
        cloth={"integrator": integrator},
    )
    assert passages(world, 2.4, 0.004) == 0
    # Twice in half is a quarter of its area, of which the third fold takes a part.
    assert ConvexHull(world.cloth.vertices("cloth")[0][:, [0, 2]]).volume < 0.16 / 4
