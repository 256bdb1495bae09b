"""Cloth whose points are nearer to one another than it is thick bends as any other, and lies on itself by its
thickness."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support import cloths
from tests.support.in_time import in_time

LENGTH, WIDTH, CELL, THICKNESS = 0.1, 0.015, 0.005, 0.01
SOFT = {"stretch_stiffness": 2000, "bend_stiffness": 0, "mass_per_area": 0.2}


@pytest.mark.parametrize("integrator", in_time("xpbd", "symplectic_euler", "implicit_euler"))
def test_a_strip_that_is_held_at_one_end_comes_to_hang(integrator):
    """Level at first; without stiffness against bending its far end comes to hang by its length below the pins. The air
    only brings it to rest."""
    strip = cloths.sheet((LENGTH, WIDTH), spacing=CELL, thickness=THICKNESS, pins=["left"], damping=0.5, **SOFT)
    made = cloths.part({"strip": strip}, integrator=integrator, air={"density": 20})
    cloths.step(made, 0.8, 0.005)
    depth = -cloths.places(made)[:, 1].min()
    assert depth == pytest.approx(LENGTH, rel=0.02)


@pytest.mark.slow
def test_sheets_keep_their_thickness_however_fine_they_are():
    """One lies on another, whose points are held."""
    size = {"spacing": CELL, "thickness": THICKNESS, **SOFT}
    below = cloths.sheet((0.05, 0.05), pins=["left", "right", "front", "back"], **size)
    above = cloths.sheet((0.03, 0.03), position=[0, 0.012, 0], **size)
    made = cloths.part({"below": below | {"stretch_stiffness": 1e5}, "above": above}, air={"density": 50})
    cloths.step(made, 0.5, 0.005)
    apart = cloths.places(made, "above")[:, 1] - cloths.places(made, "below")[:, 1].mean()
    assert apart.min() > 0.9 * THICKNESS
    assert apart.max() < 1.2 * THICKNESS


def test_which_pairs_are_thinner():
    """Points along a strip: from twice its thickness on they keep it, nearer ones have half of their distance."""
    from sim.cloth.contact.detection.crowding import Crowding
    from sim.cloth.contact.detection.search import POINT

    strip = cloths.sheet((LENGTH, WIDTH), spacing=CELL, thickness=THICKNESS, **SOFT)
    made = cloths.part({"one": strip, "other": strip | {"position": [0, 0.012, 0]}})
    mesh = made.mesh
    crowding = Crowding(mesh, np.full(mesh.total, THICKNESS / 2))
    assert crowding.present
    x = mesh.placed[: mesh.count]
    first = int(np.flatnonzero(np.isclose(x[:, 1], 0))[0])
    keys, distances = [], []
    for corners in mesh.triangles:
        if first not in corners:
            keys.append([POINT, first, *corners])
            same = np.isclose(x[corners[0], 1], 0)
            distances.append(_distance(x[first], x[corners]) if same else np.inf)
    found = crowding.thickness(np.array(keys, np.int32), np.full(len(keys), THICKNESS))
    assert found == pytest.approx(np.minimum(THICKNESS, np.array(distances) / 2), rel=1e-9)
    assert min(found) < 0.3 * THICKNESS
    assert not Crowding(mesh, np.full(mesh.total, 0.0005)).present


def _distance(point: np.ndarray, corners: np.ndarray) -> float:
    """From a point to a triangle [m], by trimesh."""
    from trimesh.triangles import closest_point

    return float(np.linalg.norm(closest_point(corners[None], point[None])[0] - point))
