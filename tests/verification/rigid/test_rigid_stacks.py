"""What stands goes on standing, and what cannot stand falls."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.bodies import G, box, ground, part, step, tilt, turn

EDGE = 0.2


def tower(ratios: list[float], **rigid: float):
    """Boxes on one another, each with a density of so many times water's, the lowest first."""
    boxes = {
        f"box{k}": box((EDGE, EDGE, EDGE), position=[0, EDGE * (k + 0.5), 0], density=1000 * ratio)
        for k, ratio in enumerate(ratios)
    }
    return part({**boxes, "floor": ground()}, **rigid)


def moved(ratios: list[float], seconds: float) -> float:
    bodies = tower(ratios)
    before = bodies.position.copy()
    step(bodies, seconds)
    return float(np.abs(bodies.position - before).max())


def test_five_boxes_stand():
    assert moved([1] * 5, 1.0) < 1e-4


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_five_boxes_stand_for_10_seconds():
    assert moved([1] * 5, 10.0) < 1e-3


@pytest.mark.parametrize("ratios", [[1, 1000], [1000, 1], [1, 1000, 1, 1000, 1]])
def test_heavy_boxes_stand_on_light_ones(ratios):
    assert moved(ratios, 1.0) < 1e-3


def test_the_floor_carries_the_weight():
    bodies = tower([1, 2, 3])
    step(bodies, 0.2)
    pairs, _, forces = bodies.state().contact_pair, None, bodies.state().contact_force
    lowest = forces[(pairs == [0, 3]).all(axis=1)].sum(axis=0)
    assert lowest == pytest.approx([0, bodies.mass[:3].sum() * G, 0], rel=1e-6, abs=1e-3)


@pytest.mark.parametrize("beside", [-0.5, 0.5])
@pytest.mark.parametrize(("width", "height"), [(0.1, 0.3), (0.2, 0.2)])
def test_a_box_on_a_slope_topples(width, height, beside):
    """When tan(theta) = width / height, to half a degree. What topples may go on to its next side, and the one after:
    it counts how far it has turned at any time, not where it is at the end."""
    angle = np.arctan(width / height) + np.radians(beside)
    up = np.array([np.sin(angle), np.cos(angle), 0]) * height / 2
    surface = {"friction": 3.0}
    body = box((width, height, 0.2), position=list(up), rotation=turn((0, 0, 1), -angle), **surface)
    bodies = part({"box": body, "slope": ground(angle, **surface)})
    turned = []
    step(bodies, 1.5, lambda _: turned.append(abs(tilt(bodies) - angle)))
    if beside < 0:
        assert max(turned) < 1e-3
    else:
        assert max(turned) > np.radians(45)


def test_deep_overlap_is_undone_slowly():
    """By moving bodies apart, which gives them no speed."""
    bodies = part({"one": box((EDGE,) * 3), "other": box((EDGE,) * 3, position=[0.05, 0.02, 0.01])}, gravity=(0, 0, 0))
    places = [bodies.position.copy()]
    step(bodies, 1.5, lambda time: places.append(bodies.position.copy()))
    assert bodies.stats["overlap"] < 1e-3 * EDGE
    assert np.linalg.norm(places[-1][1] - places[-1][0]) > EDGE
    assert np.abs(np.diff(places, axis=0)).max() <= 2 * EDGE * 0.004
    assert np.abs(bodies.velocity).max() < 1e-9


def test_a_pile_comes_to_rest():
    random = np.random.default_rng(1)
    boxes = {}
    for k in range(27):
        place = np.array([k % 3, k // 9, k // 3 % 3]) * [0.14, 0.16, 0.14] + [0, 0.1, 0] + random.uniform(0, 0.01, 3)
        rotation = turn(tuple(random.normal(size=3)), 0.3)
        boxes[f"box{k}"] = box((0.1, 0.1, 0.1), position=list(place), rotation=rotation)
    bodies = part({**boxes, "floor": ground()})
    energy = bodies.measure().kinetic_energy + bodies.measure().potential_energy
    highest = []
    step(bodies, 3.0, lambda time: highest.append(bodies.measure().kinetic_energy + bodies.measure().potential_energy))
    assert max(highest) < energy * (1 + 1e-6)
    assert np.linalg.norm(bodies.velocity, axis=1).max() < 1e-3
    assert bodies.position[:27, 1].min() > 0.0499
