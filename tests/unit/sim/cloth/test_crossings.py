"""Crossings of edges with triangles, beside a checker of its own, and what only touches."""

import numpy as np
import pytest

from tests.support.crossing import crossed

NONE = np.zeros((0, 3), int)


def lattice(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A flat square of n x n points, and its triangles."""
    x, z = np.meshgrid(np.linspace(-0.5, 0.5, n), np.linspace(-0.5, 0.5, n), indexing="ij")
    index = np.arange(n * n).reshape(n, n)
    p, q, r, s = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    triangles = np.concatenate([np.stack([p, q, s], -1).reshape(-1, 3), np.stack([p, s, r], -1).reshape(-1, 3)])
    return np.stack([x, 0 * x, z], -1).reshape(-1, 3), triangles


def layers(one, other, n: int):
    from sim.cloth.untangling.crossings import Layers

    _, triangles = lattice(n)
    return Layers([triangles, triangles + n * n, NONE], [n * n, n * n, 0]), np.concatenate([one, other])


@pytest.mark.parametrize("seed", range(4))
def test_as_many_as_the_checker_finds(seed):
    random = np.random.default_rng(seed)
    flat, triangles = lattice(9)
    places = np.concatenate([flat, flat[:, [1, 0, 2]]]) + random.normal(scale=0.08, size=(162, 3))
    whole = np.concatenate([triangles, triangles + 81])
    found = layers(places[:81], places[81:], 9)[0].cross(places)
    assert len(found) == crossed(places, whole) > 50
    a, b = (places[found.ends[:, k]] for k in range(2))
    on_edge = a + found.share[:, None] * (b - a)
    on_triangle = (found.weight[:, :, None] * places[whole[found.triangle]]).sum(axis=1)
    np.testing.assert_allclose(on_edge, on_triangle, atol=1e-6)


def test_sheets_that_cross_along_their_mass_points():
    flat, _ = lattice(9)
    made, places = layers(flat, flat[:, [1, 0, 2]], 9)
    assert len(made.cross(places)) > 8


@pytest.mark.parametrize("apart", [(0, 0, 0), (0, 0.5, 0), (1, 0, 0), (0.5, 0.5, 0)])
def test_sheets_that_only_touch(apart):
    """On each other, side by side, and one standing on or beside the other."""
    flat, _ = lattice(9)
    other = flat[:, [1, 0, 2]] if apart[1] else flat
    made, places = layers(flat, other + np.array(apart), 9)
    assert len(made.cross(places)) == 0


def test_boxes_that_overlap():
    from sim.cloth.untangling.boxes import Boxes, overlapping

    random = np.random.default_rng(0)
    sets = []
    for count in (37, 200):
        low = random.uniform(size=(count, 3))
        sets.append((low, low + random.uniform(0, 0.2, (count, 3))))
    (low, high), (other_low, other_high) = sets
    wanted = (low[:, None] <= other_high).all(axis=2) & (other_low <= high[:, None]).all(axis=2)
    found = overlapping(Boxes(low, high), Boxes(other_low, other_high))
    assert sorted(map(tuple, found)) == sorted(zip(*np.nonzero(wanted), strict=True))
    own = Boxes(other_low, other_high)
    itself = (other_low[:, None] <= other_high).all(axis=2) & (other_low <= other_high[:, None]).all(axis=2)
    assert len(overlapping(own, own)) == (itself.sum() - 200) / 2
    assert len(overlapping(own, Boxes(np.zeros((0, 3)), np.zeros((0, 3))))) == 0
