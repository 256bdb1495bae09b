"""Boundary samples that move: carried along on the device, and listed beside those that stand."""

import numpy as np
import taichi as ti

from sim.arrays import DoubleTable, IntArray, IntTable, Vec4Array, numpy_real, real, vec4
from sim.neighbors import HashGrid, NeighborList

MOTION = 18
"""Numbers that say how a body moves: rotation (9, by rows), position, velocity and angular velocity (3 each)."""


class Listed:
    """Samples that move, and lie behind `first` others in the arrays that they are written to; `here` has their
    positions [m] and weighted volumes [m^3]. radius [m] within which they are listed.

    faced: whether each is for the particles beyond a plane alone, which is in `facing`: its unit normal, and its
    distance from the origin [m].
    """

    def __init__(self, first: int, count: int, radius: float, *, faced: bool = False):
        self.first, self.count = first, count
        self.grid = HashGrid(count, radius)
        self.near = NeighborList(48)
        self.here, self.sorted = (ti.ndarray(vec4, max(count, 1)) for _ in range(2))
        self.faced = faced
        self.facing = ti.ndarray(vec4, count if faced else 1)

    def find(self, position: ti.Ndarray, count: int) -> None:
        """Sort the samples by cell and list them in `near`, by their place in the cells' order."""
        _arrange(self.count, self.grid.sort(self.here, self.count), self.here, self.sorted)
        self.near.build(position, count, self.grid, self.sorted, same=False)

    def append(self, position: ti.Ndarray, count: int, lists: NeighborList, *, fresh: bool) -> int:
        """Add what `find` has listed to the lists of others, or begin them where `fresh`.

        Returns the room that the longest needs; lists are whole where that is at most their capacity.
        """
        return _append(
            count,
            self.first,
            position,
            self.grid.order,
            self.near.size,
            self.near.index,
            self.faced,
            self.facing,
            fresh,
            lists.capacity,
            lists.size,
            lists.index,
        )

    @property
    def bytes(self) -> int:
        tables = 2 * self.count + self.facing.shape[0]
        return 4 * np.dtype(numpy_real).itemsize * tables + self.grid.bytes + self.near.bytes


class MovingSamples(Listed):
    """Samples that follow their bodies.

    arms: where they are from their body's own origin as placed [m], shape [n, 3]; body: which row of the motions is
    theirs, shape [n]; volumes: weighted [m^3], shape [n].
    """

    def __init__(self, first: int, arms: np.ndarray, body: np.ndarray, volumes: np.ndarray, radius: float):
        super().__init__(first, len(arms), radius)
        self.arms, self.body = arms, body
        bodies = int(body.max()) + 1
        self.reach = np.zeros(bodies)
        np.maximum.at(self.reach, body, np.linalg.norm(arms, axis=1))
        self._arms = ti.ndarray(vec4, self.count)
        self._arms.from_numpy(np.column_stack((arms, volumes)).astype(numpy_real))
        self._body = ti.ndarray(ti.i32, self.count)
        self._body.from_numpy(body.astype(np.int32))
        self._motions = ti.ndarray(ti.f64, (bodies, MOTION))

    def fastest(self, motions: np.ndarray) -> float:
        """The greatest speed [m/s] of a sample, from the motions of all bodies, shape [bodies, MOTION]."""
        speed, turning = np.linalg.norm(motions[:, 12:15], axis=1), np.linalg.norm(motions[:, 15:], axis=1)
        return float((speed + self.reach * turning).max())

    def move(self, motions: np.ndarray, samples: ti.Ndarray, velocity: ti.Ndarray) -> None:
        """Write positions [m] with volumes, and velocities [m/s] with a number for each body, from 1.

        motions: of all bodies, shape [bodies, MOTION].
        """
        self._motions.from_numpy(motions)
        _move(self.count, self.first, self._arms, self._body, self._motions, self.here, samples, velocity)

    @property
    def bytes(self) -> int:
        return super().bytes + (4 * np.dtype(numpy_real).itemsize + 4) * self.count


@ti.kernel
def _move(
    count: ti.i32,
    first: ti.i32,
    arms: Vec4Array,
    body: IntArray,
    motions: DoubleTable,
    here: Vec4Array,
    samples: Vec4Array,
    velocity: Vec4Array,
):
    for k in range(count):
        b = body[k]
        arm = ti.cast(arms[k].xyz, ti.f64)
        turned = ti.Vector([0.0, 0.0, 0.0], dt=ti.f64)
        for row in ti.static(range(3)):
            for column in ti.static(range(3)):
                turned[row] += motions[b, 3 * row + column] * arm[column]
        position = ti.Vector([motions[b, 9 + axis] for axis in range(3)])
        speed = ti.Vector([motions[b, 12 + axis] for axis in range(3)])
        turning = ti.Vector([motions[b, 15 + axis] for axis in range(3)])
        here[k] = vec4(ti.cast(position + turned, real), arms[k].w)
        samples[first + k] = here[k]
        velocity[first + k] = vec4(ti.cast(speed + turning.cross(turned), real), b + 1.0)


@ti.kernel
def _arrange(count: ti.i32, order: IntArray, source: Vec4Array, target: Vec4Array):
    for k in range(count):
        target[k] = source[order[k]]


@ti.kernel
def _append(
    count: ti.i32,
    first: ti.i32,
    position: Vec4Array,
    order: IntArray,
    near_size: IntArray,
    near_index: IntTable,
    faced: ti.template(),
    facing: Vec4Array,
    fresh: ti.template(),
    capacity: ti.i32,
    size: IntArray,
    index: IntTable,
) -> ti.i32:
    longest = 0
    for i in range(count):
        begin = 0
        if ti.static(not fresh):
            begin = size[i]
        end = begin
        for k in range(near_size[i]):
            sample = order[near_index[i, k]]
            if ti.static(not faced):
                if end < capacity:
                    index[i, end] = first + sample
                end += 1
            else:
                if beyond(facing[sample], position[i]):
                    if end < capacity:
                        index[i, end] = first + sample
                    end += 1
        if end <= capacity:
            size[i] = end
        ti.atomic_max(longest, end)
    return longest


@ti.func
def beyond(plane: vec4, point: vec4) -> ti.i32:
    """Whether a point is on the side of a plane that its normal points to."""
    return ti.cast(plane.xyz.dot(point.xyz) > plane.w, ti.i32)
