"""The shell's part of Newton's method for a step of implicit Euler."""

from __future__ import annotations

import numpy as np

from sim.cloth.fabric.arrays import integers, numbers, vectors
from sim.cloth.fabric.layout import AlikeRows, BlockMatrix, Points
from sim.cloth.fabric.rows import BendingRows
from sim.cloth.shell import newton_sums
from sim.cloth.shell.layout import ShellRest, ShellTrial
from sim.cloth.shell.shell import Shell
from sim.device.compiler import ti


def trial_arrays(shell: Shell) -> ShellTrial:
    """Room for what a shell is at places that are tried."""
    faces, points = np.zeros((shell.triangles, 3)), np.zeros((shell.count, 3))
    of_points = ("warp_moment", "weft_moment", "twist_moment", "normal_push", "curvature_before")
    return ShellTrial(**{name: vectors(points if name in of_points else faces) for name in ShellTrial.members})


class ShellNewton:
    """What a shell adds at the places that are tried; `pairs`, shape [p, 2]: all pairs of points in the matrix."""

    def __init__(self, shell: Shell, rest: ShellRest, pairs: np.ndarray, bending: BendingRows):
        self.terms = shell.triangles + shell.count
        """Of its energy."""
        self._count, self._triangles, self._pairs = shell.count, shell.triangles, len(pairs)
        self._rest = rest
        self._trial = trial_arrays(shell)
        first, side = _sides(shell.membrane.corners, pairs, shell.count)
        self._first, self._side = integers(first), integers(side)
        self._stiffness, self._row = numbers(bending.stiffness), numbers(bending.diagonal)
        self._entries = len(bending.stiffness)

    def begin(self, start: ti.Ndarray, place: ti.Ndarray) -> bool:
        """Begin a step from `start` [m]; returns whether an edge turns by more than a right angle on the way to
        `place` [m]."""
        return newton_sums.begin(self._triangles, self._count, start, place, self._rest, self._trial) > 0

    def assess(self, first: int, dt: float, place: ti.Ndarray, energy_term: ti.Ndarray) -> None:
        """Find stress and moments at `place` [m], and energies [J] from the `first` term on."""
        newton_sums.assess(self._triangles, self._count, first, dt, place, self._rest, self._trial, energy_term)

    def differentiate(
        self, dt: float, place: ti.Ndarray, points: Points, matrix: BlockMatrix, force: ti.Ndarray
    ) -> None:
        """Add forces [N] and blocks of the diagonal."""
        tables = self._rest, self._trial, self._row, matrix, force
        newton_sums.differentiate(self._count, dt, place, points, *tables)

    def fill_off_diagonal(self, dt: float, matrix: BlockMatrix, rows: AlikeRows) -> None:
        """Add the blocks beside the diagonal."""
        tables = self._first, self._side, self._stiffness, self._rest, self._trial, matrix, rows
        newton_sums.fill_off_diagonal(self._count, self._pairs, dt, *tables)

    @property
    def bytes(self) -> int:
        """Memory of it on the device [bytes]."""
        return 8 * (24 * self._triangles + 15 * self._count) + 8 * self._entries


def _sides(corners: np.ndarray, pairs: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Where the sides of triangles that each pair is begin, shape [p + 1], and which they are: 9 triangle + 3 corner of
    the first point + corner of the other."""
    one, other = np.array([0, 1, 2]), np.array([1, 2, 0])
    ends = np.stack([corners[:, one], corners[:, other]], axis=-1).reshape(-1, 2)
    number = 9 * np.arange(len(corners))[:, None]
    straight, turned = (number + 3 * one + other).ravel(), (number + 3 * other + one).ravel()
    side = np.where(ends[:, 0] <= ends[:, 1], straight, turned)
    key = np.sort(ends, axis=1) @ [count, 1]
    order = np.argsort(key, kind="stable")
    wanted = pairs @ [count, 1]
    begin, end = (np.searchsorted(key[order], wanted, side=where) for where in ("left", "right"))
    number = end - begin
    first = np.concatenate([[0], np.cumsum(number)])
    entries = np.arange(first[-1]) - np.repeat(first[:-1] - begin, number)
    return first, side[order][entries]
