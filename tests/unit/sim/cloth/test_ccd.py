"""When points and triangles, or edges, come near each other on their way."""

from __future__ import annotations

import numpy as np
import pytest

from sim.cloth.contact.detection.ccd import ENOUGH

PAIRS, TIMES = 400, 2001
THICKNESS, EARLY, LEAST = 0.1, 0.9, 0.25


@pytest.mark.parametrize("edges", [False, True], ids=["point and triangle", "edges"])
def test_nothing_comes_near_before_its_time_nor_too_near_unsaid(taichi, edges):
    """Advancement keeps a share ENOUGH of the distance at most; distances at TIMES tell what happens in between, but
    for what points move from one to the next."""
    from tests.unit.sim.cloth import approached

    rng = np.random.default_rng(7)
    start = rng.uniform(-0.5, 0.5, (PAIRS, 4, 3))
    first = 2 if edges else 1
    start[:, :first, 2] += rng.uniform(0.55, 1.2, (PAIRS, 1))
    way = rng.normal(0, 0.1, (PAIRS, 4, 3))
    way[:, :first, 2] -= rng.uniform(0.2, 1.5, (PAIRS, 1))
    found, distance = np.zeros((PAIRS, 17)), np.zeros((PAIRS, TIMES))
    approached.find(edges, THICKNESS, EARLY, LEAST, start, way, found, distance)
    at_start, time, narrow = found[:, 0], found[:, 1], found[:, 2] == 1
    met = time <= 1.0
    fastest = 2 * np.linalg.norm(way, axis=2).max(axis=1) / (TIMES - 1)

    np.testing.assert_allclose(at_start, distance[:, 0], rtol=0, atol=1e-12)
    before = np.linspace(0, 1, TIMES) < time[:, None]
    assert (distance > EARLY * THICKNESS)[before].all()
    then = start + np.where(met, time, 0)[:, None, None] * way
    for apart, weight, places in ((found[:, 3:6], found[:, 6:10], start), (found[:, 10:13], found[:, 13:17], then)):
        there = np.einsum("kc,kcx->kx", weight, places)
        np.testing.assert_allclose(there[met], apart[met], rtol=0, atol=1e-12)
    assert (np.linalg.norm(found[met, 10:13], axis=1) <= (1 + ENOUGH) * EARLY * THICKNESS).all()

    limit = LEAST * np.minimum(THICKNESS, at_start)
    assert (distance.min(axis=1) > limit)[~narrow].all()
    assert (distance.min(axis=1) <= (1 + ENOUGH) * limit + fastest)[narrow].all()
    assert not (narrow & ~met).any()
    assert min(np.sum(~met), np.sum(met & ~narrow), np.sum(narrow)) > PAIRS // 20


@pytest.mark.parametrize("edges", [False, True], ids=["point and triangle", "edges"])
def test_what_is_near_from_the_start_may_stay_so(taichi, edges):
    """Half of LEAST of the thickness apart: LEAST of that distance has to be kept."""
    from tests.unit.sim.cloth import approached

    gap = 0.5 * LEAST * THICKNESS
    flat = np.array(
        [[-1.0, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0]] if edges else [[0.0, 0, 0], [2, 0, 0], [-1, 2, 0], [-1, -2, 0]]
    )
    start = np.repeat(flat[None], 3, axis=0)
    start[:, : 2 if edges else 1, 2] += gap
    way = np.zeros((3, 4, 3))
    way[:, : 2 if edges else 1, 2] = np.array([0, -0.5, -0.9])[:, None] * gap
    found, distance = np.zeros((3, 17)), np.zeros((3, 2))
    approached.find(edges, THICKNESS, EARLY, LEAST, start, way, found, distance)
    assert found[:, 1].tolist() == [0, 0, 0]
    assert found[:, 2].tolist() == [0, 0, 1]
