"""Pairs of bodies that are near: boxes swept along one axis (Baraff 1992, sweep and prune)."""

from __future__ import annotations

import numpy as np


def near_pairs(low: np.ndarray, high: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Pairs of bodies whose boxes overlap, at least one of which is free to move; the smaller index first.

    low, high [m]: corners of the boxes, shape [n, 3]; free: shape [n]. Returns shape [pairs, 2].
    """
    axis = int(np.argmax(np.var(low, axis=0))) if len(low) else 0
    order = np.argsort(low[:, axis], kind="stable")
    start = low[order, axis]
    # Of each, all those that begin before it ends.
    number = np.searchsorted(start, high[order, axis], side="right") - np.arange(len(order)) - 1
    number = np.maximum(number, 0)
    one = np.repeat(np.arange(len(order)), number)
    other = np.arange(len(one)) - np.repeat(np.cumsum(number) - number, number) + one + 1
    one, other = order[one], order[other]
    touch = (free[one] | free[other]) & np.all((low[one] <= high[other]) & (low[other] <= high[one]), axis=1)
    return np.column_stack((np.minimum(one, other), np.maximum(one, other)))[touch]


def near_planes(
    centre: np.ndarray, extent: np.ndarray, free: np.ndarray, normals: np.ndarray, offsets: np.ndarray
) -> np.ndarray:
    """Pairs of a free body's index and a plane's, where the body's box reaches the plane; shape [pairs, 2].

    centre and extent [m]: middles and half edges of the boxes, shape [n, 3]; planes n . x = offset.
    """
    lowest = centre @ normals.T - extent @ np.abs(normals).T - offsets
    return np.argwhere((lowest <= 0) & free[:, None])
