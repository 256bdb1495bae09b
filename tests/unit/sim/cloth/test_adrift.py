"""Which pieces of cloth nothing holds, and what the forces left on them would do as a whole."""

from __future__ import annotations

import numpy as np
import pytest

from sim.cloth.contact.contact_set import ContactSet
from sim.cloth.contact.detection.search import EDGE, PLANE, POINT
from tests.support.cloths import part, sheet


@pytest.fixture
def cloth(taichi):
    """Two free squares of four points, and a third that is held at one side."""
    square = sheet((0.1, 0.1), spacing=0.1, mass_per_area=0.2)
    places = {"one": [0, 0, 0], "two": [0, 1, 0], "held": [0, 2, 0]}
    pins = {"held": {"pins": ["left"]}}
    return part({name: square | {"position": place} | pins.get(name, {}) for name, place in places.items()})


def contacts(*keys: tuple[int, ...]) -> ContactSet:
    none = ContactSet.none()
    return (
        none
        if not keys
        else ContactSet(np.array(keys, np.int32), *(getattr(none, name) for name in vars(none) if name != "key"))
    )


def push(cloth, *keys: tuple[int, ...]) -> np.ndarray:
    from sim.cloth.fabric.arrays import vectors
    from sim.cloth.integrators.free_pieces import FreePieces

    force = np.zeros((cloth.mesh.count, 3))
    force[0], force[5], force[9] = [1, 0, 0], [0, 3, 0], [0, 0, 7]
    found = FreePieces(cloth.mesh).push(contacts(*keys), vectors(force))
    return np.zeros_like(force) if found is None else found


WEIGHT = 0.2 * 0.1**2
"""Mass of a square [kg]."""


def test_each_piece_is_pushed_by_its_own_forces_and_held_ones_by_none(cloth):
    found = push(cloth)
    assert found[:4] == pytest.approx(np.tile([1 / WEIGHT, 0, 0], (4, 1)))
    assert found[4:8] == pytest.approx(np.tile([0, 3 / WEIGHT, 0], (4, 1)))
    assert not found[8:].any()


@pytest.mark.parametrize("key", [(POINT, 0, 4, 5, 6), (EDGE, 0, 1, 4, 5)])
def test_pieces_that_touch_are_pushed_together(cloth, key):
    assert push(cloth, key)[:8] == pytest.approx(np.tile([1 / (2 * WEIGHT), 3 / (2 * WEIGHT), 0], (8, 1)))


@pytest.mark.parametrize("key", [(PLANE, 0, -1, -1, -1), (POINT, 0, 12, 13, 14), (POINT, 0, 8, 9, 10)])
def test_what_touches_a_plane_a_solid_or_held_cloth_is_left_alone(cloth, key):
    found = push(cloth, key)
    assert not found[:4].any()
    assert found[4:8] == pytest.approx(np.tile([0, 3 / WEIGHT, 0], (4, 1)))


@pytest.mark.parametrize(("others", "share"), [(0.0, 1.0), (0.1, 0.8), (0.5, 0.0), (1.0, 0.0)])
def test_what_falls_does_so_the_less_the_more_acts_on_it(cloth, others, share):
    """Forces of `others`, over gravity; a towel that touches a plane falls no more than what is held."""
    from sim.cloth.integrators.free_pieces import FreePieces

    gravity = np.array([0.0, -10.0, 0.0])
    change = np.tile((1 - others) * gravity, (cloth.mesh.count, 1))
    found = FreePieces(cloth.mesh).falling(contacts((PLANE, 0, -1, -1, -1)), gravity, change)
    expected = np.repeat([0.0, share, 0.0], 4)[:, None]
    assert (np.zeros_like(expected) if found is None else found) == pytest.approx(expected)


def test_nothing_falls_without_gravity(cloth):
    from sim.cloth.integrators.free_pieces import FreePieces

    assert FreePieces(cloth.mesh).falling(contacts(), np.zeros(3), np.zeros((cloth.mesh.count, 3))) is None
