"""Constraints in groups without a common point."""

from __future__ import annotations

import itertools

import numpy as np


def colored(members: np.ndarray, count: int) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """An order of constraints on the points `members`, shape [n, k], and where each colour begins and ends in it.

    A colour takes all constraints that no neighbour keeps out; which comes first is drawn by lot, always the same
    (Luby 1986).
    """
    number = len(members)
    color = np.full(number, -1)
    lot = np.random.default_rng(1).permutation(number)
    current = 0
    while (color < 0).any():
        waiting = np.flatnonzero(color < 0)
        while len(waiting):
            first = np.full(count, number)
            np.minimum.at(first, members[waiting].ravel(), np.repeat(lot[waiting], members.shape[1]))
            chosen = waiting[(first[members[waiting]] == lot[waiting][:, None]).all(axis=1)]
            color[chosen] = current
            taken = np.zeros(count, bool)
            taken[members[chosen].ravel()] = True
            waiting = waiting[~taken[members[waiting]].any(axis=1)]
        current += 1
    order = np.argsort(color, kind="stable")
    starts = np.searchsorted(color[order], np.arange(current + 1))
    return order, [(int(a), int(b)) for a, b in itertools.pairwise(starts)]
