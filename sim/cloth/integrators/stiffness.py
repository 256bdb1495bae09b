"""The matrix of a step of Newton's method without contacts: blocks of three by three, in rows of points.

Which points meet in a spring or a hinge does not change, so its pattern is found once.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from sim.cloth.fabric.arrays import integers, matrices
from sim.cloth.fabric.layout import Rows


@dataclass(frozen=True)
class Pattern:
    """Rows of a matrix; `pairs`: number of pairs of points that meet."""

    pairs: int
    rows: Rows


def find_pattern(springs: np.ndarray, hinges: np.ndarray, count: int) -> Pattern:
    """For springs, shape [s, 2], and hinges, shape [h, 4], of so many points."""
    ends, ties = [springs], [-1 - np.arange(len(springs))]
    for one, other in itertools.combinations(range(4), 2):
        ends.append(hinges[:, [one, other]])
        ties.append(16 * np.arange(len(hinges)) + 4 * one + other)
    end, tie = np.concatenate(ends), np.concatenate(ties)
    turn = end[:, 0] > end[:, 1]
    end = np.sort(end, axis=1)
    tie = np.where(turn & (tie >= 0), tie - tie % 16 + 4 * (tie % 4) + tie % 16 // 4, tie)
    order = np.lexsort((tie, end[:, 1], end[:, 0]))
    pair, first = np.unique(end[order], axis=0, return_index=True)
    row, column = np.concatenate([pair, pair[:, ::-1]]).T
    by_rows = np.lexsort((column, row))
    slot = np.empty(len(row), int)
    slot[by_rows] = np.arange(len(row))
    rows = Rows(
        first_block=integers(np.searchsorted(row[by_rows], np.arange(count + 1))),
        column=integers(column[by_rows]),
        first_tie=integers(np.append(first, len(order))),
        of_tie=integers(tie[order]),
        slot=integers(slot.reshape(2, -1).T.ravel()),
        off_block=matrices(len(row)),
        own_block=matrices(count),
        alone_block=matrices(count),
    )
    return Pattern(len(pair), rows)
