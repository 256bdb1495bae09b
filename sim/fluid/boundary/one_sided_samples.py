"""Samples that move, each for the particles on one side of it, and those near each particle."""

from abc import ABC, abstractmethod

import numpy as np

from sim.device.arrays import IntArray, Vec4Array, numpy_real, vec4
from sim.device.compiler import ti
from sim.neighbors.spatial_hash import HashGrid, NeighborList, Neighbors


class OneSidedSamples(ABC):
    """`here` has positions [m] and weighted volumes [m^3]; radius [m] within which samples are listed.

    facing: the plane beyond which the particles are that a sample is for: its unit normal, and its distance from the
    origin [m].
    """

    def __init__(self, count: int, radius: float):
        self.count = count
        self.grid = HashGrid(count, radius)
        self.near = NeighborList(16)
        self.here, self.sorted, self.facing = (ti.ndarray(vec4, max(count, 1)) for _ in range(3))

    @abstractmethod
    def move(self, samples: ti.Ndarray, velocity: ti.Ndarray) -> float:
        """Write positions [m] with volumes [m^3], and velocities [m/s]; returns the greatest speed [m/s]."""

    def find(self, position: ti.Ndarray, count: int) -> None:
        """Sort the samples by cell and list them in `near`, by their place in the cells' order."""
        _arrange(self.count, self.grid.sort(self.here, self.count), self.here, self.sorted)
        self.near.build(position, count, self.grid, self.sorted, same=False)

    def tell(self, position: ti.Ndarray, count: int, lists: NeighborList) -> None:
        """Write what `find` has listed, by number, and for the particles that samples are for."""
        lists.match(self.near, count)
        _tell(count, position, self.grid.order, self.near.lists, self.facing, lists.lists)

    @property
    def bytes(self) -> int:
        """Memory of the samples, their cells, and the lists of those near particles [bytes]."""
        return 12 * np.dtype(numpy_real).itemsize * self.count + self.grid.bytes + self.near.bytes


@ti.kernel
def _arrange(count: ti.i32, order: IntArray, source: Vec4Array, target: Vec4Array):
    for k in range(count):
        target[k] = source[order[k]]


@ti.kernel
def _tell(
    count: ti.i32,
    position: Vec4Array,
    order: IntArray,
    near: Neighbors,
    facing: Vec4Array,
    lists: Neighbors,
):
    for i in range(count):
        slot = near.begin[i]
        lists.begin[i] = slot
        for k in range(near.size[i]):
            sample = order[near.index[near.begin[i] + k]]
            if beyond(facing[sample], position[i]):
                lists.index[slot] = sample
                slot += 1
        lists.size[i] = slot - near.begin[i]


@ti.func
def beyond(plane: vec4, point: vec4) -> ti.i32:
    """Whether a point is on the side of a plane that its normal points to."""
    return ti.cast(plane.xyz.dot(point.xyz) > plane.w, ti.i32)
