"""What comes near is found whatever moves, by trees as well as by trying all pairs."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

HALF, EARLY = 0.05, 0.95
TRIANGLES = 60


def soup(rng: np.random.Generator) -> np.ndarray:
    """Corners of small triangles here and there in a cube [m], shape [3 n, 3]."""
    middle = rng.uniform(-0.5, 0.5, (TRIANGLES, 1, 3))
    return (middle + rng.normal(0, 0.1, (TRIANGLES, 3, 3))).reshape(-1, 3)


def moving(drift: float, own: float) -> tuple[np.ndarray, np.ndarray]:
    """Places before and after: all go as far as `drift`, and each triangle about `own` besides [m]."""
    rng = np.random.default_rng(5)
    start = soup(rng)
    way = np.repeat(rng.normal(0, own, (TRIANGLES, 3)), 3, axis=0) + rng.normal(0, own / 4, start.shape)
    return start, start + way + [drift, -2 * drift, drift / 3]


@pytest.mark.parametrize("edges", [False, True], ids=["points and triangles", "edges"])
@pytest.mark.parametrize(("drift", "own"), [(0.0, 0.0), (0.0, 0.2), (7.0, 0.2), (7.0, 0.0)])
def test_all_that_comes_near_is_found(taichi, edges, drift, own):
    from sim.cloth.contact.detection.pair_search import PairSearch
    from sim.cloth.contact.detection.surfaces import Surface
    from sim.cloth.fabric.arrays import numbers, vectors
    from tests.unit.sim.cloth import approached

    start, end = moving(drift, own)
    surface = Surface.of(np.arange(3 * TRIANGLES).reshape(-1, 3))
    points, triangles, sides = surface.trees(start)
    search = PairSearch(True, sides, sides) if edges else PairSearch(False, points, triangles)
    half, before, after = numbers(np.full(len(start), HALF)), vectors(start), vectors(end)
    for tree in (points, triangles, sides):
        tree.enclose(half, before, after)
    found = search.run(half, before, after, EARLY).corners

    if edges:
        pairs = [(*one, *other) for one, other in itertools.combinations(surface.edges.tolist(), 2)]
    else:
        pairs = [(point, *corners) for point in surface.points for corners in surface.triangles]
    tried = np.array([pair for pair in pairs if len(set(pair)) == 4], np.int32)
    told = np.zeros((len(tried), 17)), np.zeros((len(tried), 1))
    approached.find(edges, 2 * HALF, EARLY, 0.25, start[tried], (end - start)[tried], *told)
    expected = tried[told[0][:, 1] <= 1.0]
    assert len(expected) > 20
    assert len(found) == len(expected)
    assert _distinct(found, edges) == _distinct(expected, edges)


def _distinct(corners: np.ndarray, edges: bool) -> set[tuple]:
    """Pairs; of two edges either may come first."""
    rows = map(tuple, corners.tolist())
    return {tuple(sorted((row[:2], row[2:]))) for row in rows} if edges else set(rows)
