"""Contacts of pairs of bodies where closed forms tell them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.support.bodies import ball, box, part, step, turn


def contacts(bodies: dict) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places [m], normals and gaps [m] of the contacts of two bodies."""
    found = part(bodies, gravity=(0, 0, 0))
    found.velocity[:] = 0
    count = found.contacts.find(0.001)
    tables = found.contacts.tables
    return tables.table["place"][:count], tables.table["normal"][:count], tables.gap[:count]


def test_two_balls():
    places, normals, gaps = contacts({"a": ball(0.1), "b": ball(0.2, position=[0, 0.2999, 0])})
    assert places == pytest.approx(np.array([[0, 0.1 - 0.00005, 0]]), abs=1e-12)
    assert normals == pytest.approx(np.array([[0, -1, 0]]), abs=1e-12)
    assert gaps == pytest.approx([-0.0001], abs=1e-12)


def test_a_ball_on_a_box():
    places, normals, gaps = contacts({"a": ball(0.1, position=[0.03, 0.2, 0]), "b": box((0.4, 0.2, 0.4))})
    assert places == pytest.approx(np.array([[0.03, 0.1, 0]]), abs=1e-12)
    assert normals == pytest.approx(np.array([[0, 1, 0]]), abs=1e-12)
    assert gaps == pytest.approx([0], abs=1e-12)


def test_faces_of_boxes_meet_in_the_corners_of_what_they_share():
    places, normals, gaps = contacts({"a": box((0.2, 0.2, 0.2)), "b": box((1, 0.2, 0.1), position=[0.4, -0.2, 0])})
    assert {(round(x, 9), round(z, 9)) for x, _, z in places} == {
        (-0.1, -0.05),
        (-0.1, 0.05),
        (0.1, -0.05),
        (0.1, 0.05),
    }
    assert normals == pytest.approx(np.tile([0, 1, 0], (4, 1)))
    assert gaps == pytest.approx(np.zeros(4), abs=1e-12)


def test_a_box_turned_on_another_has_four_contacts_that_surround_its_middle():
    turned = box((0.2, 0.2, 0.2), position=[0, 0.2, 0], rotation=turn((0, 1, 0), np.pi / 4))
    places, _, gaps = contacts({"a": turned, "b": box((0.2, 0.2, 0.2))})
    assert len(gaps) == 4
    assert places.mean(axis=0) == pytest.approx([0, 0.1, 0], abs=0.02)
    assert np.ptp(places[:, 0]) > 0.15 and np.ptp(places[:, 2]) > 0.15


def test_edges_of_boxes_cross_in_one_point():
    tilted = turn((0, 0, 1), np.pi / 4)
    upper = [{"axis": (1, 0, 0), "angle": 45}]
    height = 0.2 / np.sqrt(2)
    places, normals, gaps = contacts(
        {
            "a": box((0.6, 0.2, 0.2), position=[0.05, 2 * height, 0], rotation=upper),
            "b": box((0.2, 0.2, 0.6), position=[0, 0, 0.03], rotation=tilted),
        }
    )
    assert places == pytest.approx(np.array([[0, height, 0]]), abs=1e-9)
    assert normals == pytest.approx(np.array([[0, 1, 0]]), abs=1e-9)
    assert gaps == pytest.approx([0], abs=1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0])
def test_the_rim_of_a_cylinder_touches_with_its_lowest_point(angle):
    """A cylinder tilted by an angle reaches R sin(angle) + H/2 cos(angle) below its centre."""
    depth = 0.1 * np.sin(angle) + 0.15 * np.cos(angle)
    cylinder = {"motion": "dynamic", "shape": {"type": "cylinder", "radius": 0.1, "height": 0.3}}
    floor = {"shape": {"type": "plane"}}
    _, normals, gaps = contacts(
        {"a": {**cylinder, "rotation": turn((0.6, 0, 0.8), angle), "position": [0, depth, 0]}, "floor": floor}
    )
    assert gaps.min() == pytest.approx(0, abs=1e-9)
    assert normals == pytest.approx(np.tile([0, 1, 0], (len(gaps), 1)))
    assert len(gaps) >= 3 if angle == 0 else len(gaps) == 1


def test_a_capsule_across_another_touches_in_one_point():
    capsule = {"motion": "dynamic", "shape": {"type": "capsule", "radius": 0.1, "height": 0.6}}
    places, normals, gaps = contacts(
        {
            "a": {**capsule, "rotation": turn((1, 0, 0), np.pi / 2), "position": [0.07, 0.2, 0.04]},
            "b": {**capsule, "rotation": turn((0, 0, 1), np.pi / 2)},
        }
    )
    assert places == pytest.approx(np.array([[0.07, 0.1, 0]]), abs=1e-6)
    assert normals == pytest.approx(np.array([[0, 1, 0]]), abs=1e-6)
    assert gaps == pytest.approx([0], abs=1e-9)


CYLINDER = {"motion": "dynamic", "shape": {"type": "cylinder", "radius": 0.1, "height": 0.6}}


@pytest.mark.parametrize("angle", [0.3, 1.0, np.pi / 2])
def test_a_cylinder_across_another_touches_in_one_point(angle):
    across = (np.sin(angle), 0, np.cos(angle))
    places, normals, gaps = contacts(
        {
            "a": {
                **CYLINDER,
                "rotation": turn(across, np.pi / 2),
                "position": [0.07, 0.2, 0],
            },
            "b": {**CYLINDER, "rotation": turn((0, 0, 1), np.pi / 2)},
        }
    )
    assert places == pytest.approx(np.array([[0.07, 0.1, 0]]), abs=1e-6)
    assert normals == pytest.approx(np.array([[0, 1, 0]]), abs=1e-6)
    assert gaps == pytest.approx([0], abs=1e-9)


def test_the_round_side_of_a_cylinder_ends_at_its_rims():
    """One stands on the floor beside the end of another that lies there: their faces are 0.05 apart."""
    _, _, gaps = contacts(
        {
            "a": {**CYLINDER, "rotation": turn((0, 0, 1), np.pi / 2), "position": [0.0, 0.1, 0]},
            "b": {**CYLINDER, "position": [0.45, 0.3, 0]},
        }
    )
    assert not len(gaps)
    _, normals, gaps = contacts(
        {
            "a": {**CYLINDER, "rotation": turn((0, 0, 1), np.pi / 2), "position": [0.0, 0.1, 0]},
            "b": {**CYLINDER, "position": [0.4, 0.3, 0]},
        }
    )
    assert gaps.min() == pytest.approx(0, abs=1e-9)
    assert normals[gaps.argmin()] == pytest.approx([-1, 0, 0], abs=1e-6)


def test_a_cylinder_lies_across_another_and_stays():
    floor = {"shape": {"type": "plane"}}
    lower = {**CYLINDER, "motion": "static", "rotation": turn((0, 0, 1), np.pi / 2), "position": [0, 0.1, 0]}
    upper = {**CYLINDER, "density": 500, "rotation": turn((1, 0, 0), np.pi / 2), "position": [0, 0.32, 0]}
    run = part({"upper": upper, "lower": lower, "floor": floor})
    step(run, 1.0)
    assert run.position[0] == pytest.approx([0, 0.3, 0], abs=1e-3)


@pytest.mark.parametrize("depth", [0.0, 0.0005, 0.03])
def test_what_begins_inside_another_is_told(depth):
    """From a hundredth of the smaller one's size on."""
    bodies = {"upper": box((0.2, 0.2, 0.2), position=[0, 0.2 - depth, 0]), "lower": box((0.4, 0.2, 0.4))}
    told = part(bodies | {"ball": ball(0.1, position=[2, 0, 0])}).overlaps()
    assert told == ([("upper", "lower", pytest.approx(depth))] if depth > 0.002 else [])


FLOOR = {"shape": {"type": "plane"}}
EIGHTH = turn((0, 0, 1), np.pi / 4)
PAIRS = {
    "a corner": (box((1, 1, 1)), box((1, 1, 1), position=[0.9, 0.9, 0.9])),
    "all of a face": (box((1, 1, 1)), box((1, 1, 1), position=[0, 0.97, 0])),
    "next to nothing": (box((1, 1, 1)), box((1, 1, 1), position=[0, 0.995, 0])),
    "side by side": (box((1, 1, 1)), box((1, 1, 1), position=[1.01, 0, 0])),
    "crossed beams": (box((3, 0.2, 0.2)), box((0.2, 3, 0.2))),
    "crossed edges": (box((1, 1, 1), rotation=EIGHTH), box((1, 1, 1), rotation=EIGHTH, position=[1.36, 0.1, 0.4])),
    "balls": (ball(0.1), ball(0.2, position=[0, 0.28, 0])),
    "one in the other": (ball(0.1), box((1, 1, 1))),
    "a ball in the floor": (ball(0.1, position=[0, 0.05, 0]), FLOOR),
    "a box on the floor": (box((1, 1, 1), position=[0, 0.5, 0]), FLOOR),
    "far apart": (ball(0.1), ball(0.2, position=[0, 3, 0])),
}


@pytest.mark.parametrize("case", PAIRS)
def test_what_is_told_before_anything_is_built_is_what_the_run_tells(case):
    """Of the same pairs; the depth of a point is at most the way that takes the bodies apart."""
    from sim.bodies.obstacles import find_obstacles
    from sim.bodies.overlaps import overlaps
    from sim.spec import SimulationSpec

    bodies = dict(zip("ab", PAIRS[case], strict=True))
    spec = SimulationSpec.model_validate({"rigid": {"bodies": bodies}})
    told = {frozenset(pair): depth for *pair, depth in overlaps(find_obstacles(spec, Path()))}
    known = {frozenset(pair): depth for *pair, depth in part(bodies).overlaps()}
    assert told.keys() == known.keys()
    assert all(told[pair] <= 1.001 * known[pair] for pair in known)
