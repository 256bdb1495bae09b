"""The matrix of a step of Newton's method without contacts: blocks of three by three, in rows of points.

Which points meet in a spring or a hinge does not change, so its pattern is found once.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from sim.cloth.fabric.arrays import integers, matrices
from sim.cloth.fabric.layout import BlockMatrix


@dataclass(frozen=True)
class Pattern:
    """A matrix; `pairs`: number of pairs of points that meet."""

    pairs: int
    matrix: BlockMatrix


def find_pattern(springs: np.ndarray, hinges: np.ndarray, count: int) -> Pattern:
    """For springs, shape [s, 2], and hinges, shape [h, 4], of so many points."""
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
    pair, first = np.unique(end[order], axis=0, return_index=True)
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
    return Pattern(len(pair), matrix)
