"""The matrix of a step of Newton's method without contacts: blocks of three by three, in rows of points.

Which points meet in a spring or a hinge does not change, so its pattern is found once.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from sim.cloth.fabric.arrays import integers, matrices, numbers
from sim.cloth.fabric.layout import AlikeRows, BlockMatrix
from sim.cloth.fabric.rows import BendingRows


@dataclass(frozen=True)
class Pattern:
    """A matrix, in two parts; `pairs`: points that meet, shape [p, 2]."""

    pairs: np.ndarray
    matrix: BlockMatrix
    alike: AlikeRows


def find_pattern(
    springs: np.ndarray, hinges: np.ndarray, count: int, edges: np.ndarray, bending: BendingRows
) -> Pattern:
    """For springs, shape [s, 2], and hinges, shape [h, 4], of so many points; and for the edges of a shell, shape
    [e, 2], and its bending."""
    ends, elements = [springs], [-1 - np.arange(len(springs))]
    for one, other in itertools.combinations(range(4), 2):
        ends.append(hinges[:, [one, other]])
        elements.append(16 * np.arange(len(hinges)) + 4 * one + other)
    end, element = np.concatenate(ends), np.concatenate(elements)
    turn = end[:, 0] > end[:, 1]
    end = np.sort(end, axis=1)
    turned = element - element % 16 + 4 * (element % 4) + element % 16 // 4
    element = np.where(turn & (element >= 0), turned, element)
    order = np.lexsort((element, end[:, 1], end[:, 0]))
    pair = np.unique(np.concatenate([end, edges]), axis=0)
    first = np.searchsorted(end[order] @ [count, 1], pair @ [count, 1])
    row, column = np.concatenate([pair, pair[:, ::-1]]).T
    by_rows = np.lexsort((column, row))
    slot = np.empty(len(row), int)
    slot[by_rows] = np.arange(len(row))
    matrix = BlockMatrix(
        first_block=integers(np.searchsorted(row[by_rows], np.arange(count + 1))),
        column=integers(column[by_rows]),
        first_element=integers(np.append(first, len(order))),
        of_element=integers(element[order]),
        slot=integers(slot.reshape(2, -1).T.ravel()),
        off_diagonal=matrices(len(row)),
        diagonal=matrices(count),
        inertial_diagonal=matrices(count),
    )
    alike = AlikeRows(
        first_alike=integers(bending.first),
        alike_column=integers(bending.column),
        alike=numbers(np.zeros(len(bending.column))),
    )
    return Pattern(pair, matrix, alike)
