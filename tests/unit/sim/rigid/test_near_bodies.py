"""Bodies that may touch within a step, by each tried with each, and by a sweep."""

from __future__ import annotations

import numpy as np
import pytest

from sim.rigid.collision.detection import FEW, ROOM
from tests.support.bodies import ball, box, ground, part


@pytest.fixture(scope="module")
def crowd():
    """More near pairs than there is room for at first, bodies that do not obey forces among them, and two planes."""
    random = np.random.default_rng(5)
    bodies = {}
    for k in range(90):
        place = random.uniform(-0.4, 0.4, 3).tolist()
        velocity, spin = random.normal(size=(2, 3)).tolist()
        moving = {"position": place, "velocity": velocity, "angular_velocity": spin}
        bodies[f"body{k}"] = (ball(0.08, **moving), box((0.1, 0.05, 0.2), **moving))[k % 2]
        if k % 5 == 0:
            bodies[f"body{k}"] = {"shape": bodies[f"body{k}"]["shape"], "position": place}
    made = part({**bodies, "ground": ground(), "slope": ground(1.2)})
    assert made.count <= FEW
    return made


def listed(found, count: int) -> tuple[np.ndarray, np.ndarray]:
    tables = found.tables
    return tables.near.pair_body[: 2 * count].reshape(-1, 2).copy(), tables.margin[:count].copy()


def test_both_ways_list_the_same_pairs_in_the_same_order(crowd):
    found = crowd.contacts
    few, few_margin = listed(found, found._list_few(0.004))
    many, many_margin = listed(found, found._list_many(0.004))
    assert len(few) > ROOM
    assert few.tolist() == many.tolist() == sorted(few.tolist())
    assert few_margin == pytest.approx(many_margin, rel=1e-12)
    assert {crowd.count - 2, crowd.count - 1} <= set(few[:, 1].tolist())


def test_contacts_are_those_of_both_ways(crowd, monkeypatch):
    count = crowd.contacts.find(0.004)
    few = crowd.contacts.pair_of_contact.copy(), crowd.contacts.tables.gap[:count].copy()
    monkeypatch.setattr("sim.rigid.collision.detection.FEW", 0)
    assert crowd.contacts.find(0.004) == count > 0
    assert crowd.contacts.pair_of_contact.tolist() == few[0].tolist()
    assert crowd.contacts.tables.gap[:count] == pytest.approx(few[1], abs=1e-12)


def test_what_bodies_are_to_each_other_is_looked_up_again_when_pairs_change():
    """Three balls in a row, of which the middle one leaves one and comes to the other."""
    frictions = {"a": 0.1, "b": 0.4, "c": 0.9}
    bodies = {name: ball(0.1, position=[0.3 * k, 0, 0], friction=frictions[name]) for k, name in enumerate("abc")}
    made = part(bodies, gravity=(0, 0, 0))
    for place, one, other in ((0.1999, "a", "b"), (0.4001, "b", "c"), (0.1999, "a", "b")):
        made.position[1, 0] = place
        assert made.contacts.find(0.001) == 1
        expected = np.sqrt(frictions[one] * frictions[other])
        assert made.contacts.tables.table["kinetic_friction"][0] == pytest.approx(expected)
