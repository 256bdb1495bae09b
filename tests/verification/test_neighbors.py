"""The hashed neighbour search against a search through all pairs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree


def listed(points: np.ndarray, others: np.ndarray | None, h: float) -> list[set[int]]:
    """Neighbour sets by former index, as the hash grid finds them."""
    from sim.device.arrays import Declared, Particles
    from sim.neighbors.spatial_hash import HashGrid, NeighborList

    particles = Particles([Declared("position", "vec4", "m"), Declared("tag", "vec2i", "")], 0)
    tags = np.column_stack((np.arange(len(points)), np.zeros(len(points)))).astype(np.int32)
    particles.load({"position": np.column_stack((points, np.zeros(len(points)))).astype(np.float32), "tag": tags})
    grid = HashGrid(len(points), h)
    particles.reorder(grid.sort(particles.position, len(points)))
    lists = NeighborList(8)
    former = particles.numpy("tag")[:, 0]
    if others is None:
        lists.build(particles.position, len(points), grid, particles.position, same=True)
        names = former
    else:
        there = Particles([Declared("position", "vec4", "m")], 0)
        there.load({"position": np.column_stack((others, np.zeros(len(others)))).astype(np.float32)})
        cells = HashGrid(len(others), h)
        names = cells.sort(there.position, len(others)).to_numpy()[: len(others)]
        there.reorder(cells.order)
        lists.build(particles.position, len(points), cells, there.position, same=False)
    begin, size, index = (array.to_numpy() for array in (lists.begin, lists.size, lists.index))
    found: list[set[int]] = [set()] * len(points)
    for row in range(len(points)):
        first, end = begin[row], begin[row] + size[row]
        assert len(set(index[first:end])) == size[row], "a neighbour is listed twice"
        found[former[row]] = {int(names[j]) for j in index[first:end]}
        if others is None:
            full = first + -(-size[row] // 8) * 8
            assert (index[end:full] == row).all(), "the list is padded with the particle itself"
    return found


CLOUDS = {
    "a dense ball": lambda rng: rng.normal(size=(400, 3)) * 0.12,
    "far apart, over many periods of the hash": lambda rng: (
        rng.uniform(-50, 50, size=(60, 3)).repeat(5, axis=0) + rng.uniform(-0.06, 0.06, size=(300, 3))
    ),
    "negative coordinates and a line": lambda rng: np.column_stack((np.linspace(-3, 0, 200), np.full((200, 2), -1.0))),
    "one particle": lambda rng: np.array([[0.3, -0.2, 0.1]]),
}


@pytest.mark.parametrize("cloud", CLOUDS)
@pytest.mark.parametrize("others_than_itself", [False, True])
def test_finds_exactly_the_pairs_in_the_support(taichi, cloud, others_than_itself):
    rng = np.random.default_rng(1)
    h = 0.1
    points = CLOUDS[cloud](rng).astype(np.float32).astype(np.float64)
    others = None
    if others_than_itself:
        others = (points[rng.integers(0, len(points), 150)] + rng.normal(size=(150, 3)) * 0.05).astype(np.float32)
    target = points if others is None else others.astype(np.float64)
    expected = cKDTree(points).query_ball_tree(cKDTree(target), h * (1 + 1e-6))
    certain = cKDTree(points).query_ball_tree(cKDTree(target), h * (1 - 1e-6))
    for i, (found, most, least) in enumerate(zip(listed(points, others, h), expected, certain, strict=True)):
        itself = {i} if others is None else set()
        assert set(least) - itself <= found <= set(most) - itself


def test_order_does_not_depend_on_the_run(taichi):
    rng = np.random.default_rng(2)
    points = rng.normal(size=(3000, 3)).astype(np.float32) * 0.3
    from sim.device.arrays import vec4
    from sim.neighbors.spatial_hash import HashGrid

    position = taichi.ndarray(vec4, len(points))
    position.from_numpy(np.column_stack((points, np.zeros(len(points)))).astype(np.float32))
    grid = HashGrid(len(points), 0.1)
    orders = [grid.sort(position, len(points)).to_numpy()[: len(points)] for _ in range(5)]
    assert sorted(orders[0]) == list(range(len(points)))
    for order in orders[1:]:
        np.testing.assert_array_equal(order, orders[0])


@pytest.mark.parametrize("seed", [3, 8])
@pytest.mark.parametrize("room", range(8, 73, 8))
def test_lists_with_room_of_their_own_grow_to_what_they_need(taichi, seed, room):
    """As on a GPU, whatever is needed next."""
    from sim.device.arrays import vec4
    from sim.neighbors.spatial_hash import HashGrid, NeighborList

    points = np.random.default_rng(seed).normal(size=(64, 3)).astype(np.float32) * 0.06
    position = taichi.ndarray(vec4, 64)
    position.from_numpy(np.column_stack((points, np.zeros(64))).astype(np.float32))
    grid = HashGrid(64, 0.1)
    points = points[grid.sort(position, 64).to_numpy()[:64]]
    position.from_numpy(np.column_stack((points, np.zeros(64))).astype(np.float32))
    lists = NeighborList(1)
    lists._page, lists._room = 1, room
    lists._allocate(64)
    lists.build(position, 64, grid, position, same=True)
    begin, size, index = (array.to_numpy() for array in (lists.begin, lists.size, lists.index))
    for i, found in enumerate(cKDTree(points).query_ball_point(points, 0.1)):
        assert set(index[begin[i] : begin[i] + size[i]]) == set(found) - {i}


@pytest.mark.parametrize("seed", [3, 8, 32, 72])
def test_lists_are_whole_whatever_room_they_begin_with(taichi, seed):
    """Where a page is just filled, also by a list that needs no padding, and where it lacks an entry."""
    from sim.device.arrays import vec4
    from sim.neighbors.spatial_hash import PAGE, HashGrid, NeighborList

    points = np.random.default_rng(seed).normal(size=(PAGE, 3)).astype(np.float32) * 0.06
    position = taichi.ndarray(vec4, PAGE)
    grid = HashGrid(PAGE, 0.1)
    position.from_numpy(np.column_stack((points, np.zeros(PAGE))).astype(np.float32))
    points = points[grid.sort(position, PAGE).to_numpy()[:PAGE]]
    position.from_numpy(np.column_stack((points, np.zeros(PAGE))).astype(np.float32))
    expected = [set(found) - {i} for i, found in enumerate(cKDTree(points).query_ball_point(points, 0.1))]
    needed = sum(-(-len(found) // 8) * 8 for found in expected)
    for room in range(needed - 16, needed + 17):
        lists = NeighborList(1)
        lists._room = room
        lists._allocate(PAGE)
        lists.build(position, PAGE, grid, position, same=True)
        begin, size, index = (array.to_numpy() for array in (lists.begin, lists.size, lists.index))
        assert [set(index[first : first + length]) for first, length in zip(begin, size, strict=True)] == expected
